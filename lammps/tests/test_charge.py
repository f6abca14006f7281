# SPDX-License-Identifier: MIT
"""fix amberfield/charge: closed forms of the transfer, balances, and what must not matter."""

import numpy as np
import pytest
from support import RANKS, data_file, run, start

PERMITTIVITY = 8.8541878128e-12
CUTOFF = 5e-7
RADIUS = 1e-4
BOX = ([0.0, 0.0, 0.0], [0.002, 0.002, 0.002])
GRANULAR = "pair_style gran/hertz/history 1e6 NULL 0 NULL 0 0\npair_coeff * *"
# Sums of as many charges as a bed has, in different orders
ROUND_OFF = 1e-13
WALLS = """
region floor plane 0 0 0 0 0 1
region lid plane 0 0 0.002 0 0 -1
fix F all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
fix L all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region lid
"""
KINDS = "wall floor work 4.2 grounded wall lid work 4.2 insulating"


def input_of(boundary="f f f"):
    """First commands, with elastic contacts of 1 MPa without friction."""
    return start(boundary, pair=GRANULAR) + "fix N all nve/sphere\ntimestep 2e-7\n"


def in_slices(commands, ranks):
    """The commands with a box that is cut across x: 2 and 4 ranks have a border in its middle."""
    return commands.replace("read_data", f"processors {ranks} 1 1\nread_data", 1)


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
    charge = f"fix C all amberfield/charge work 1 4.5 work 2 4.2 cutoff {CUTOFF}\nrun 2000"
    state = run(tmp_path, [[in_slices(head, ranks) + charge, "end"]], ranks=ranks)["end"]
    moved = q[0] - state["q"][0, 0]
    assert state["v"][0, 0] < -0.09
    expected = between_grains(q, [4.5, 4.2], area_of(0.2))
    # The impact begins between two steps: the largest overlap is a step's share off.
    assert abs(moved / expected - 1) < 2e-3
    assert abs(state["q"].sum() - q.sum()) < ROUND_OFF * abs(q).sum()


@pytest.mark.parametrize("ranks", [1, 2, 3, 4])
def test_closed_forms_hold_at_every_border(tmp_path, ranks):
    # Pairs that meet in a periodic face, on all borders of 2, 3 and 4 ranks and elsewhere, and grains that
    # land there on a grounded floor and on an insulating lid.
    places = 0.002 * np.array([0.0, 1 / 4, 1 / 3, 1 / 2, 2 / 3, 3 / 4, 0.9])
    lanes = 0.002 * (np.arange(len(places)) + 0.5) / len(places)
    half, height = RADIUS + 5e-7, RADIUS + 5e-7
    x, v, q, types = [], [], [], []
    for place, lane in zip(places, lanes, strict=True):
        x += [[place - half, lane, 0.001], [place + half, lane, 0.001], [place, lane, height]]
        x += [[place, lane, 0.002 - height]]
        v += [[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.0, 0.0, -0.1], [0.0, 0.0, 0.1]]
        q += [3e-13, -1e-13, 1e-13, 1e-13]
        types += [1, 2, 1, 2]
    types = np.array(types)

    def gained(q, more):
        data_file(tmp_path / "data.grains", np.array(x) % 0.002, q, BOX, types=types, v=v)
        charge = f"fix C all amberfield/charge work 1 4.5 work 2 4.2 cutoff {CUTOFF} {KINDS} {more}\nrun 250"
        commands = in_slices(input_of("p f f"), ranks) + WALLS + charge
        state = run(tmp_path, [[commands, "end"]], ranks=ranks, arrays=[("spots", "C")])["end"]
        assert len(state["spots"]) == len(places)
        change = (state["q"][:, 0] - q).reshape(-1, 4)
        assert abs(np.array(state["spots"])[:, 3] + change[:, 3]).max() < 1e-12 * abs(change).max()
        assert abs(change - change[0]).max() < 1e-9 * abs(change).max()
        return change[0]

    surface = 2 * np.pi * RADIUS**2
    # Up to breakdown, where it comes early.
    limit = 100 * PERMITTIVITY * surface
    bound = gained(np.zeros(len(x)), "breakdown 100")
    assert abs(bound - [-limit, limit, -limit, 0.0]).max() < 1e-9 * limit

    free = gained(np.array(q), "")
    of_pair = between_grains(q, [4.5, 4.2], area_of(0.2))
    assert abs(free[:2] / [-of_pair, of_pair] - 1).max() < 2e-3
    area = area_of(0.1, reduced=1.0, effective=1.0)
    # The image of a charged grain doubles its field in a conductor, and an insulator has none.
    for grain, own, work in [(2, surface, 4.5), (3, 2 * surface, 4.2)]:
        drive = PERMITTIVITY * (work - 4.2) / CUTOFF + 1e-13 / own
        expected = drive * surface * np.expm1(-area / surface)
        assert abs(free[grain] / expected - 1) < 2e-3


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


def wall_run(folder, charge, steps, height=RADIUS + 5e-7, speed=-0.1, walls="", parts=(), ranks=1):
    x = np.array([[0.001, 0.001, height]])
    data_file(folder / "data.grains", x, np.zeros(1), BOX, v=np.array([[0.0, 0.0, speed]]))
    floor = """
region floor plane 0 0 0 0 0 1
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
"""
    head = in_slices(input_of("p f f"), ranks) + (walls or floor) + charge
    arrays = [("spots", "C")] if "insulating" in charge else []
    whole = [[head + f"\nrun {steps}", "end"], *parts]
    return run(folder, whole, ranks=ranks, globals=[("wall", "C", 0)], arrays=arrays)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("kind", ["grounded", "insulating"])
def test_bounces_on_a_wall_follow_the_exponential(tmp_path, ranks, kind):
    # A lid brings the grain back: each bounce takes the same share of what is missing. The charge that an
    # insulator keeps acts on the contact as the grain's image does in a conductor.
    lid = """
region slit block INF INF INF INF 0 2.02e-4
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region slit
"""
    charge = f"fix C all amberfield/charge work 1 5.5 cutoff {CUTOFF} wall slit work 4.5 {kind}"
    parts = [[f"run {20 * n}", str(n)] for n in range(1, 60)]
    states = wall_run(tmp_path, charge, 1, walls=lid, parts=parts, height=1.01e-4, ranks=ranks)
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
        if kind == "insulating":
            assert abs(sum(spot[3] for spot in state["spots"]) - state["wall"]) < ROUND_OFF * abs(steady)


@pytest.mark.parametrize("kind", ["grounded", "insulating"])
def test_breakdown_ends_the_charging(tmp_path, kind):
    charge = f"fix C all amberfield/charge work 1 5.5 cutoff {CUTOFF} wall floor work 4.5 {kind}"
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


def bed(folder, ranks, boundary, steps, field="", more="", side=8, speed=0.1, step=2e-7):
    """A bed in which grains of two materials meet again and again."""
    random = np.random.default_rng(11)
    spacing = 0.002 / side
    x = (np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5) * spacing
    v = random.normal(0.0, speed, x.shape)
    q = random.normal(0.0, 1e-15, len(x))
    data_file(folder / "data.grains", x, q - q.mean(), BOX, types=random.integers(1, 3, len(x)), v=v)
    commands = (
        input_of(boundary)
        + f"timestep {step}\n"
        + field
        + f"fix C all amberfield/charge work 1 4.0 work 2 4.5 cutoff {CUTOFF} {more}\n"
    )
    parts = [[commands + f"run {steps}", "end"]]
    books = [("moved", "C", 1), ("walls", "C", 0)]
    keeps = "insulating" in more
    books += [("lid", "C", 3)] if keeps else []
    arrays = [("spots", "C")] if keeps else []
    return run(folder, parts, ranks=ranks, globals=books, arrays=arrays)["end"]


@pytest.mark.parametrize("ranks", RANKS)
@pytest.mark.parametrize("boundary", ["p p p", "p p f"])
def test_charge_is_conserved_over_a_hundred_thousand_steps(tmp_path, ranks, boundary):
    wall, more = (WALLS, KINDS) if boundary == "p p f" else ("", "")
    state = bed(tmp_path, ranks, boundary, 100_000, field=wall, more=more, side=4, speed=0.3, step=1e-6)
    total = state["q"].sum() + state["walls"]
    # All have met again and again, and are charged.
    assert state["moved"] > 0.4 * abs(state["q"]).sum() and abs(state["q"]).max() > 1e-13
    assert abs(total) < ROUND_OFF * state["moved"] and abs(total) < 1e-12 * abs(state["q"]).sum()
    if wall:
        assert abs(sum(spot[3] for spot in state["spots"]) - state["lid"]) < ROUND_OFF * state["moved"]


def test_first_contacts_are_the_same_on_any_number_of_ranks(tmp_path):
    beds = (bed(tmp_path, ranks, "p p f", 800, WALLS, KINDS, speed=0.3) for ranks in (1, 2, 3))
    one, *others = beds
    assert len(one["spots"]) > 3
    for state in others:
        assert abs(one["q"] - state["q"]).max() < 1e-9 * abs(one["q"]).max()
        spots = np.array(one["spots"]) - state["spots"]
        assert (abs(spots).max(0) < 1e-9 * abs(np.array(one["spots"])).max(0)).all()


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


def field_of_kept(offset, normal, scale, side):
    """Field of a kept charge over k Q: "Charge kept by insulating walls" in docs/equations.md."""
    offset, normal = np.asarray(offset, float), np.asarray(normal, float)
    height = offset @ normal
    along2 = max(offset @ offset - height**2, 0.0)
    near = max(1 - abs(height) / scale, 0.0)
    spread = max(1 - along2 / (6 * scale**2), 0.0)
    distance = np.sqrt(offset @ offset)
    return offset / max(distance, scale) ** 3 + normal * np.sign(side) * near * spread**2 / scale**2


COULOMB = 1 / (4 * np.pi * PERMITTIVITY)
INSULATING = f"fix C all amberfield/charge work 1 5.5 cutoff {CUTOFF} wall floor work 4.5 insulating"


def test_what_a_grain_left_on_an_insulator_keeps_others_off(tmp_path):
    # Two grains, one after the other, at places half a radius apart.
    floor = """
region floor plane 0 0 0 0 0 1
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
neigh_modify exclude group all all
"""
    apart, height = 0.5 * RADIUS, RADIUS + 5e-7
    x = np.array([[0.001, 0.001, height], [0.001 + apart, 0.001, height + 1e-4]])
    data_file(tmp_path / "data.grains", x, np.zeros(2), BOX, v=np.array([[0.0, 0.0, -0.1]] * 2))
    commands = input_of() + floor + INSULATING
    parts = [[commands + "\nrun 4000", "one"], ["run 4500", "both"]]
    states = run(tmp_path, parts, arrays=[("spots", "C")])
    first = states["one"]["q"][0, 0]
    assert states["one"]["q"][1, 0] == 0.0 and states["both"]["q"][0, 0] == first
    # One spot takes both, and stands for both at the mean of their places.
    (spot,) = states["both"]["spots"]
    second = states["both"]["q"][1, 0]
    assert abs(spot[3] + first + second) < ROUND_OFF * abs(first)
    area = area_of(0.1, reduced=1.0, effective=1.0)
    kept = -first * COULOMB * field_of_kept([apart, 0, 0], [0, 0, 1], RADIUS, 1.0)[2]
    share = field_of_kept([apart, 0, 0], [0, 0, 1], RADIUS, 1.0)[2] / (4 * np.pi)
    decay = 1 / (4 * np.pi * RADIUS**2) + share
    drive = PERMITTIVITY / CUTOFF - PERMITTIVITY * kept
    expected = -drive / decay * -np.expm1(-decay * area)
    bare = -PERMITTIVITY / CUTOFF * area
    assert abs(expected / bare - 1) > 5e-3
    assert abs(second / expected - 1) < 2e-3


@pytest.mark.parametrize("ranks", [1, 2])
def test_field_has_the_charge_that_walls_keep(tmp_path, ranks):
    floor = """
region floor plane 0 0 0 0 0 1
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
"""
    field = "fix E all amberfield/field tolerance 1e-6 boundary o o o every 1\n"
    x = np.array([[0.001, 0.001, RADIUS + 5e-7], [0.0013, 0.001, 5e-4]])
    v = np.array([[0.0, 0.0, -0.1], [0.0, 0.0, 0.0]])
    data_file(tmp_path / "data.grains", x, np.zeros(2), BOX, v=v)
    commands = in_slices(input_of(), ranks) + floor + field + INSULATING
    state = run(
        tmp_path, [[commands + "\nrun 700", "end"]], ranks=ranks, fixes=["E"], arrays=[("spots", "C")]
    )["end"]
    (spot,) = state["spots"]
    charge, scale = spot[3], spot[4]
    assert charge > 0 and state["q"][0, 0] == -charge
    expected = COULOMB * charge * field_of_kept(state["x"][0] - spot[:3], [0, 0, 1], scale, 1.0)
    assert abs(state["e"][0] - expected).max() < 1e-5 * abs(expected).max()
    # And the other grain, a distance away, both of them as points.
    point = np.array(spot[:3]) + [0, 0, 0.1 * scale]
    from_spot, from_grain = state["x"][1] - point, state["x"][1] - state["x"][0]
    expected = (
        COULOMB
        * charge
        * (from_spot / np.linalg.norm(from_spot) ** 3 - from_grain / np.linalg.norm(from_grain) ** 3)
    )
    assert abs(state["e"][1] - expected).max() < 1e-5 * abs(expected).max()


@pytest.mark.parametrize("ranks", [1, 2])
def test_charge_on_a_wall_that_turns_goes_along_and_through_a_restart(tmp_path, ranks):
    turning = """
variable angle equal 2*PI*step*dt/1e-2
region floor cylinder y 0.001 0.001 0.0009 INF INF side in rotate v_angle 0.001 0.001 0.001 0 1 0
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
"""
    height = 0.0001 + RADIUS + 5e-7
    parts = [["run 1000\nwrite_restart turned.restart", "turned"], ["run 250", "on"]]
    states = wall_run(tmp_path, INSULATING, 500, height=height, walls=turning, parts=parts, ranks=ranks)
    head = input_of().replace("atom_style hybrid sphere charge\natom_modify map array\nboundary f f f\n", "")
    head = head.replace("units si\n", "").replace("read_data data.grains", "read_restart turned.restart")
    again = [[head + turning + INSULATING + "\nrun 0", "turned"], ["run 250", "on"]]
    resumed = run(tmp_path, again, ranks=ranks, globals=[("wall", "C", 0)], arrays=[("spots", "C")])

    def angle(spot):
        return np.arctan2(spot[0] - 0.001, spot[2] - 0.001)

    (begun,), (turned,) = states["end"]["spots"], states["turned"]["spots"]
    # 1/50 of a turn in 1000 steps of 2e-7 s, about y from z to x.
    assert abs(np.angle(np.exp(1j * (angle(turned) - angle(begun) - 2 * np.pi / 50)))) < 1e-9
    assert begun[3] == turned[3] == states["turned"]["wall"] != 0
    for name in ("turned", "on"):
        (spot,), (same,) = states[name]["spots"], resumed[name]["spots"]
        assert abs(np.array(spot) - same).max() < 1e-12
        assert resumed[name]["wall"] == states[name]["wall"]


def test_grain_that_is_the_largest_only_later_feels_what_others_left(tmp_path):
    # A small grain lands first. The second one is as small when the run is set up, or large at once.
    floor = """
region floor plane 0 0 0 0 0 1
fix W all wall/gran/region granular hertz 1e6 0 tangential linear_nohistory 0 0 region floor
neigh_modify exclude group all all
"""
    small, apart = 0.2 * RADIUS, 1.6 * RADIUS
    x = np.array([[0.001, 0.001, small + 5e-7], [0.001 + apart, 0.001, RADIUS + 1e-4]])
    grows = "group two id 2\nvariable wide equal 2e-4\nfix G two adapt 0 atom diameter v_wide\n"
    found = []
    for name, radii, more in (("at-once", [small, RADIUS], ""), ("later", [small, small], grows)):
        folder = tmp_path / name
        folder.mkdir()
        data_file(
            folder / "data.grains", x, np.zeros(2), BOX, radius=radii, v=np.array([[0.0, 0.0, -0.1]] * 2)
        )
        head = (
            input_of().replace("hybrid sphere charge", "hybrid sphere 1 charge") + "comm_modify cutoff 5e-4\n"
        )
        state = run(folder, [[head + floor + more + INSULATING + "\nrun 8500", "both"]])["both"]
        found.append(state["q"][:, 0])
    assert found[0][0] < 0 and found[0][1] < 0
    assert np.array_equal(found[0], found[1])

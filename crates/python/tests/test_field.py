"""Field of arrays."""

import threading
import time

import amberfield
import numpy as np
import pytest
from conftest import COULOMB, command

PERIODIC = "periodic"


def rms(vectors):
    return np.sqrt(np.mean(np.sum(vectors**2, axis=1)))


def test_two_charges_in_open_space_have_coulombs_field():
    values = amberfield.field(
        [[0.004, 0.005, 0.005], [0.006, 0.005, 0.005]], [1e-9, -2e-9], box=[0.01, 0.01, 0.01]
    )
    strength = COULOMB / 0.002**2
    np.testing.assert_allclose(
        values.e, [[2e-9 * strength, 0, 0], [1e-9 * strength, 0, 0]], rtol=1e-9, atol=1e-6
    )
    np.testing.assert_allclose(values.potential, [-2e-9 * COULOMB / 0.002, 1e-9 * COULOMB / 0.002], rtol=1e-9)


def test_rock_salt_has_madelungs_potential():
    # Madelung's constant of NaCl: 1.747564594633 (Borwein, Borwein, Taylor, J. Math. Phys. 26, 2999, 1985).
    places = np.array([[i, j, k] for i in range(4) for j in range(4) for k in range(4)]) + 0.25
    signs = np.where(places.astype(int).sum(axis=1) % 2 == 0, 1.0, -1.0)
    values = amberfield.field(places * 1e-3, signs * 1e-12, [4e-3] * 3, PERIODIC, tolerance=1e-5)
    expected = -1.747564594633 * signs * 1e-12 * COULOMB / 1e-3
    np.testing.assert_allclose(values.potential, expected, rtol=2e-5)


@pytest.mark.parametrize(
    "asked", [{"method": "p3m"}, {"method": "direct"}, {"method": "cutoff", "field_cutoff_radius": 2e-3}]
)
def test_whole_periods_away_is_the_same_place_at_every_call(asked):
    random = np.random.default_rng(5)
    box, faces = [0.01, 0.02, 0.03], {"x": "periodic", "y": "grounded", "z": "periodic"}
    places, charges = random.uniform(0.0, 1.0, (60, 3)) * box, np.where(np.arange(60) % 2 == 0, 1e-12, -1e-12)
    away = places + random.integers(-2, 3, (60, 3)) * np.array(box) * [1, 0, 1]
    made = amberfield.Field(box, faces, 1e-4, **asked)
    expected = made(places, charges).e
    for _ in range(3):
        np.testing.assert_allclose(made(away, charges).e, expected, rtol=0, atol=1e-9 * rms(expected))
    fresh = amberfield.Field(box, faces, 1e-4, **asked)
    np.testing.assert_allclose(fresh(away, charges).e, expected, rtol=0, atol=1e-9 * rms(expected))


def test_a_charge_beside_a_grounded_face_is_drawn_by_its_image():
    faces = {"x": "open", "y": "open", "z_min": "grounded", "z_max": "open"}
    values = amberfield.field([[0.5, 0.5, 0.001]], [1e-9], [1, 1, 1], faces)
    np.testing.assert_allclose(values.e[0, 2], -1e-9 * COULOMB / 0.002**2, rtol=1e-6)


def test_plates_at_a_voltage_have_an_even_field_and_components_add_up():
    faces = {"x": PERIODIC, "y": PERIODIC, "z": ("grounded", {"potential_V": 500.0})}
    values = amberfield.field([[0.2, 0.3, 0.4]], [0.0], [1, 1, 0.5], faces, components=True)
    np.testing.assert_allclose(values.e, [[0.0, 0.0, -1000.0]], atol=1e-9)
    np.testing.assert_allclose(values.potential, [400.0])
    np.testing.assert_allclose(sum(values.components.values()), values.e, atol=1e-9)


@pytest.mark.parametrize(
    "faces", [PERIODIC, "grounded", {"x": PERIODIC, "y": PERIODIC, "z": "grounded"}, "open"]
)
def test_the_stated_error_is_that_against_the_direct_sum(charges, faces):
    positions, charge = charges
    asked = amberfield.field(positions, charge, [0.01] * 3, faces, tolerance=1e-3)
    exact = amberfield.field(positions, charge, [0.01] * 3, faces, method="direct")
    true = rms(asked.e - exact.e) / rms(exact.e)
    assert true < 1e-3
    if asked.error is not None and true > 1e-12:
        assert 0.5 < asked.error / true < 2.0


def test_what_must_not_matter(charges):
    positions, charge = charges
    box, faces = [0.01] * 3, {"x": PERIODIC, "y": PERIODIC, "z": "grounded"}
    field = amberfield.Field(box, faces, tolerance=1e-4)
    e = field(positions, charge).e
    same = dict(rtol=0, atol=1e-9 * rms(e))
    # Near pairs are summed in single precision: another order of the sum rounds a large field otherwise.
    rounded = dict(rtol=4e-7, atol=1e-6 * rms(e))
    # Layout, type and container of the arrays.
    np.testing.assert_array_equal(field(np.asfortranarray(positions), charge).e, e)
    np.testing.assert_array_equal(field(np.repeat(positions, 2, axis=0)[::2], np.repeat(charge, 2)[::2]).e, e)
    np.testing.assert_array_equal(field(positions.tolist(), charge.tolist()).e, e)
    # Whole periods, order, units of charge.
    moved = positions + [0.01, -0.03, 0.0]
    np.testing.assert_allclose(field(moved, charge).e, e, **rounded)
    order = np.random.default_rng(1).permutation(len(charge))
    np.testing.assert_allclose(field(positions[order], charge[order]).e, e[order], **rounded)
    np.testing.assert_allclose(field(positions, -4.0 * charge).e, -4.0 * e, **same)
    # Number of threads.
    for threads in (1, 2, 3):
        field = amberfield.Field(box, faces, tolerance=1e-4, threads=threads)
        np.testing.assert_array_equal(field(positions, charge).e, e)
    # Place of the box.
    shift = np.array([0.5, -0.25, 0.125])
    shifted = amberfield.field(positions + shift, charge, [shift, shift + 0.01], faces, tolerance=1e-4)
    np.testing.assert_allclose(shifted.e, e, rtol=0, atol=1e-6 * rms(e))


def test_the_input_stays_as_it_is_and_results_live_on(charges):
    positions, charge = (array.copy() for array in charges)
    positions.flags.writeable = charge.flags.writeable = False
    first = amberfield.field(positions, charge, [0.01] * 3, "grounded")
    kept = first.e.copy()
    amberfield.field(positions, 2.0 * charge, [0.01] * 3, "grounded")
    np.testing.assert_array_equal(first.e, kept)
    np.testing.assert_array_equal(positions, charges[0])


def test_a_field_keeps_its_parameters(charges):
    positions, charge = charges
    field = amberfield.Field([0.01] * 3, PERIODIC, tolerance=1e-3)
    assert field.parameters is None and field.error is None
    field(positions, charge)
    parameters = field.parameters
    field(0.99 * positions[:200], charge[:200] - charge[:200].mean())
    assert field.parameters == parameters
    assert 0.0 < field.error < 1e-3
    assert 0.0 < field.measure_error(positions, charge) < 1e-3


def test_the_field_is_that_of_the_command(charges, tmp_path):
    positions, charge = charges
    rows = [
        f"{i},{x!r},{y!r},{z!r},1e-5,{q!r}"
        for i, ((x, y, z), q) in enumerate(zip(positions.tolist(), charge.tolist()))
    ]
    (tmp_path / "grains.csv").write_text("id,x_m,y_m,z_m,radius_m,charge_C\n" + "\n".join(rows))
    (tmp_path / "scene.toml").write_text(
        '[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.01, 0.01, 0.01]\nboundary = { x = "periodic", y = "open", '
        'z = "grounded" }\n[particles]\nfile = "grains.csv"\n[electric_field]\ntolerance = 1e-3\n'
    )
    command("field", tmp_path / "scene.toml", "--out", tmp_path / "e.csv")
    theirs = np.genfromtxt(tmp_path / "e.csv", delimiter=",", names=True)
    faces = {"x": PERIODIC, "y": "open", "z": "grounded"}
    ours = amberfield.field(positions, charge, [0.01] * 3, faces, tolerance=1e-3)
    for axis, name in enumerate(("ex_V_per_m", "ey_V_per_m", "ez_V_per_m")):
        np.testing.assert_array_equal(ours.e[:, axis], theirs[name])
    np.testing.assert_array_equal(ours.potential, theirs["potential_V"])


def test_other_threads_of_python_go_on(charges):
    random = np.random.default_rng(5)
    positions, charge = random.uniform(0, 1, (20_000, 3)), random.choice([-1e-12, 1e-12], 20_000)
    ticks, stop = [], threading.Event()

    def count():
        while not stop.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    begun = time.perf_counter()
    amberfield.field(positions, charge, [1, 1, 1], method="direct", threads=1)
    seconds = time.perf_counter() - begun
    stop.set()
    thread.join()
    gaps = np.diff([begun, *ticks])
    assert seconds > 0.3 and gaps.max() < 0.5 * seconds


def test_an_error_above_the_tolerance_is_raised_with_the_field(charges, monkeypatch):
    class Strict(amberfield._native.NativeField):
        """Field that finds its own tolerance met too badly."""

        tolerance = 1e-9

    monkeypatch.setattr(amberfield._native, "NativeField", Strict)
    with pytest.raises(amberfield.ToleranceError, match="above the tolerance") as caught:
        amberfield.field(*charges, [0.01] * 3, PERIODIC, tolerance=1e-3)
    assert caught.value.exit_code == 4
    assert caught.value.values.error > 1e-9 and caught.value.values.e.shape == (300, 3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (dict(positions=np.zeros((3, 2))), "positions: its shape is"),
        (dict(positions=np.zeros(3)), "positions: its shape is (3,); give an array of shape (n, 3)"),
        (dict(charges=[1e-9]), "charges: there are 1 for 2 positions"),
        (dict(charges=["a", "b"]), "charges: its numbers are"),
        (dict(charges=[1j, 2]), "charges: its numbers are complex128"),
        (dict(charges=[np.nan, 0.0]), "finite"),
        (dict(positions=[[0.5, 0.5, 0.5], [0.5, 0.5, 1.5]]), "on or beyond a face"),
        (dict(box=[1, 1]), "box: its shape is (2,)"),
        (dict(box=[[0, 1], [0, 1], [0, 1]]), "transpose"),
        (dict(box=[1, -1, 1]), "max_m"),
        (dict(faces="groundd"), "nearest"),
        (dict(faces={"w": "open"}), "faces: 'w' is no face"),
        (dict(faces={"x_min": ("open", "open")}), "faces: x_min: give one condition"),
        (dict(faces={"x": PERIODIC}), "faces['y_min']"),
        (dict(faces={"x": {"potential_v": 3.0}, "y": "open", "z": "open"}), "potential_V"),
        (dict(tolerance=-1.0), "tolerance"),
        (dict(method="pppm"), "p3m"),
        (dict(tolerence=1e-3), "tolerence"),
        (dict(threads=0), "threads"),
        (dict(faces="insulating"), "net charge"),
        (dict(external_field_V_m=None), "external_field_V_m: the value is None"),
    ],
)
def test_nonsense_is_refused_with_words(change, words):
    good = dict(
        positions=[[0.5, 0.5, 0.5], [0.25, 0.5, 0.5]], charges=[1e-9, 1e-9], box=[1, 1, 1], faces="grounded"
    )
    with pytest.raises(amberfield.InputError) as caught:
        amberfield.field(**{**good, **change})
    assert words in str(caught.value)
    assert caught.value.exit_code == 2 and isinstance(caught.value, ValueError)


def test_no_charges_have_no_field():
    values = amberfield.field(np.zeros((0, 3)), [], [1, 1, 1], "grounded")
    assert values.e.shape == (0, 3) and values.potential.shape == (0,)

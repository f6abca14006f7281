"""Files of grains."""

import gzip

import amberfield
import numpy as np
import pytest

ELEMENTARY_CHARGE = 1.602176634e-19


@pytest.fixture
def grains():
    random = np.random.default_rng(11)
    n = 40
    return amberfield.Grains(
        id=np.arange(1, n + 1, dtype=np.uint64),
        position_m=random.uniform(0.0, 0.01, (n, 3)),
        velocity_m_s=random.normal(0.0, 0.1, (n, 3)),
        angular_velocity_rad_s=random.normal(0.0, 10.0, (n, 3)),
        radius_m=random.uniform(1e-4, 2e-4, n),
        density_kg_m3=np.full(n, 2500.0),
        charge_C=random.normal(0.0, 1e-14, n),
        material=np.zeros(n, dtype=np.uint16),
        materials=["glass"],
        step=500,
        box_m=np.array([[0.0, 0.0, 0.0], [0.01, 0.01, 0.02]]),
        is_periodic=(True, True, False),
    )


NUMBERS = (
    "id",
    "position_m",
    "velocity_m_s",
    "angular_velocity_rad_s",
    "radius_m",
    "density_kg_m3",
    "charge_C",
)


@pytest.mark.parametrize("ending", ["csv", "vtu", "dump", "lammpstrj"])
def test_what_is_written_is_read_again_to_the_last_digit(grains, tmp_path, ending):
    path = tmp_path / f"grains.{ending}"
    grains.write(path)
    again = amberfield.read(path, units="si" if ending in ("dump", "lammpstrj") else None)
    for name in NUMBERS:
        np.testing.assert_array_equal(getattr(again, name), getattr(grains, name), err_msg=name)


def test_units_of_lammps_are_those_of_its_manual(tmp_path):
    # Style nano: nanometres, elementary charges, nanometres per nanosecond; style micro: picocoulombs.
    text = (
        "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp ff\n0 10\n0 10\n0 20\n"
        "ITEM: ATOMS id type x y z vx vy vz q radius\n3 1 1 2 3 4 5 6 -2 0.5\n"
    )
    path = tmp_path / "one.dump"
    path.write_text(text)
    nano = amberfield.read(path, units="nano")
    np.testing.assert_allclose(nano.position_m, [[1e-9, 2e-9, 3e-9]], rtol=1e-15)
    np.testing.assert_allclose(nano.charge_C, [-2 * ELEMENTARY_CHARGE], rtol=1e-9)
    np.testing.assert_allclose(nano.velocity_m_s, [[4.0, 5.0, 6.0]], rtol=1e-15)
    np.testing.assert_allclose(nano.box_m, [[0, 0, 0], [1e-8, 1e-8, 2e-8]], rtol=1e-15)
    assert (nano.step, nano.is_periodic) == (7, (True, True, False))
    micro = amberfield.read(path, units="micro")
    np.testing.assert_allclose(micro.charge_C, [-2e-12], rtol=1e-15)
    np.testing.assert_allclose(micro.radius_m, [0.5e-6], rtol=1e-15)
    with pytest.raises(amberfield.InputError, match="units"):
        amberfield.read(path)
    with pytest.raises(amberfield.InputError, match="lj has no units"):
        amberfield.read(path, units="lj")


def test_a_packed_file_with_decimal_commas_is_read(tmp_path):
    path = tmp_path / "grains.csv.gz"
    path.write_bytes(gzip.compress(b"x_mm;y_mm;z_mm;diameter_um;charge_pC\r\n1,5;2;3;200;-0,25\r\n"))
    grains = amberfield.read(path)
    np.testing.assert_allclose(grains.position_m, [[1.5e-3, 2e-3, 3e-3]], rtol=1e-15)
    np.testing.assert_allclose([grains.radius_m[0], grains.charge_C[0]], [1e-4, -0.25e-12], rtol=1e-15)
    assert grains.velocity_m_s is None and grains.density_kg_m3 is None


def test_what_is_missing_is_left_out(grains, tmp_path):
    bare = amberfield.Grains(id=grains.id, position_m=grains.position_m, charge_C=grains.charge_C)
    bare.write(tmp_path / "bare.csv")
    again = amberfield.read(tmp_path / "bare.csv")
    assert again.radius_m is None and again.velocity_m_s is None
    np.testing.assert_array_equal(again.charge_C, grains.charge_C)
    assert list(bare.to_pandas().columns) == ["id", "x_m", "y_m", "z_m", "charge_C"]


def test_nonsense_is_refused_with_words(grains, tmp_path):
    with pytest.raises(amberfield.InputError, match="no form"):
        grains.write(tmp_path / "grains.xyz")
    grains.radius_m = grains.radius_m[:3]
    with pytest.raises(amberfield.InputError, match="radius_m: its shape is"):
        grains.write(tmp_path / "grains.csv")
    with pytest.raises(amberfield.InputError, match="there is no file"):
        amberfield.read(tmp_path / "nowhere.csv")


def test_a_dump_that_was_read_gives_a_field(grains, tmp_path):
    grains.write(tmp_path / "grains.dump")
    again = amberfield.read(tmp_path / "grains.dump", units="si")
    faces = {"x": "periodic", "y": "periodic", "z": "grounded"}
    values = amberfield.field(again.position_m, again.charge_C, again.box_m, faces, tolerance=1e-3)
    assert values.error is None or values.error < 1e-3

"""Pictures."""

import subprocess
import sys
from pathlib import Path

import amberfield
import numpy as np
import pytest


@pytest.fixture
def grains():
    n = 5
    zeros = np.zeros((n, 3))
    places = np.column_stack([np.arange(n), np.zeros(n), np.arange(n) ** 2]).astype(float)
    return amberfield.Grains(
        id=np.arange(n, dtype=np.uint64),
        position_m=places,
        velocity_m_s=zeros,
        angular_velocity_rad_s=zeros,
        radius_m=np.full(n, 0.5),
        density_kg_m3=np.full(n, 2500.0),
        charge_C=np.array([-1.0, 0.0, 1.0, 2.0, 3.0]),
        time_s=0.25,
    )


def test_grains_are_discs_of_their_size_at_their_places(grains):
    ax = grains.plot()
    discs = ax.collections[0]
    np.testing.assert_allclose(discs.get_offsets(), grains.position_m[:, [0, 2]])
    np.testing.assert_allclose(discs.get_widths(), 1.0)
    assert discs.get_clim() == (-3.0, 3.0)
    assert ax.get_xlabel() == "x [m]" and ax.get_title() == "t = 0.25 s"
    ax.figure.canvas.draw()


def test_who_is_nearer_is_drawn_in_front(grains):
    grains.position_m = np.column_stack([np.zeros(5), [3.0, 1.0, 2.0, 5.0, 4.0], np.zeros(5)])
    # Seen with x to the right and z upwards, the eye is at negative y.
    drawn = grains.plot(plane="xz").collections[0].get_array()
    np.testing.assert_array_equal(drawn, grains.charge_C[[3, 4, 0, 2, 1]])


def test_any_numbers_give_the_colour(grains):
    colours = np.linspace(0.0, 1.0, 5)
    np.testing.assert_array_equal(grains.plot(colours).collections[0].get_array(), colours)


@pytest.mark.parametrize("plane", ["xx", "x", "xw", "xyz"])
def test_planes_are_two_axes(grains, plane):
    with pytest.raises(amberfield.InputError, match="plane"):
        grains.plot(plane=plane)


def test_a_colour_for_each_grain(grains):
    with pytest.raises(amberfield.InputError, match="one number for each of 5 grains"):
        grains.plot(np.zeros(4))


def test_a_table_has_the_columns_of_a_particle_file(grains):
    table = grains.to_pandas()
    assert list(table.columns)[:5] == ["id", "x_m", "y_m", "z_m", "vx_m_s"]
    np.testing.assert_array_equal(table["z_m"], grains.position_m[:, 2])


def test_a_history_is_drawn(bed, tmp_path):
    run = amberfield.run(bed, tmp_path / "run", progress=False)
    ax = run.plot()
    assert [line.get_label() for line in ax.lines] == ["kinetic_J", "contact_J", "gravity_J", "electric_J"]
    with pytest.raises(amberfield.InputError, match="there is no 'speed'"):
        run.plot(["speed"])


def test_the_example_draws_its_picture(tmp_path):
    example = Path(__file__).parents[1] / "examples" / "field_of_a_snapshot.py"
    picture = tmp_path / "field.png"
    done = subprocess.run([sys.executable, example, picture], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("1000 grains")
    assert picture.read_bytes().startswith(b"\x89PNG")

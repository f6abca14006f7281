"""Helpers of the tests."""

import os
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pytest

matplotlib.use("Agg")

#: Vacuum permittivity, CODATA 2018 [F/m].
EPSILON_0 = 8.8541878128e-12
#: Coulomb's constant [N m²/C²].
COULOMB = 1.0 / (4.0 * np.pi * EPSILON_0)


def command(*arguments, cwd=None, check=True):
    """Run ``amberfield`` of this environment."""
    program = Path(sys.executable).with_name("amberfield")
    done = subprocess.run(
        [program, *map(os.fspath, map(str, arguments))], cwd=cwd, capture_output=True, text=True
    )
    if check and done.returncode != 0:
        raise AssertionError(f"exit code {done.returncode}: {done.stderr}")
    return done


@pytest.fixture
def charges():
    """300 charges in a box of 10 mm, as many of either sign: positions, charges."""
    random = np.random.default_rng(7)
    return random.uniform(0.0, 0.01, (300, 3)), random.permutation(np.repeat([-1e-14, 1e-14], 150))


@pytest.fixture
def bed():
    """Small scene as a dict: charged grains that fall onto a floor between grounded plates."""
    return {
        "domain": {
            "min_m": [0.0, 0.0, 0.0],
            "max_m": [0.01, 0.01, 0.02],
            "boundary": {"x": "periodic", "y": "periodic", "z": "grounded"},
        },
        "materials": [
            {
                "name": "glass",
                "density_kg_m3": 2500.0,
                "young_Pa": 1e7,
                "poisson": 0.22,
                "restitution": 0.9,
                "friction": 0.3,
            }
        ],
        "walls": [{"plane": {"point_m": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]}}],
        "particles": {
            "generate": {
                "material": "glass",
                "count": 200,
                "radius_m": 4e-4,
                "charge_C": {"bipolar": 1e-13},
                "seed": 3,
            }
        },
        "time": {"step_s": 2e-6, "end_s": 2e-3, "gravity_m_s2": [0.0, 0.0, -9.81]},
        "electric_field": {"tolerance": 1e-2},
        "output": {"every_s": 5e-4, "history_every_s": 2e-4},
    }

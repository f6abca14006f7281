# SPDX-License-Identifier: MIT
"""The beds that `cargo xtask bench --peers lammps` measures, small: all runs, with errors."""

import os
import subprocess
import sys

import numpy as np
import pytest
from support import HERE, PLUGIN, SECONDS, command, error, exact_field, grains, keeps_promise

SCRIPT = HERE.parent.parent / "crates/study/peers/lammps_bed.py"
RADIUS = 1e-3


def bed(folder, count):
    """Grains that move, as the script reads them."""
    edge = (count * 4 / 3 * np.pi * RADIUS**3 / 0.3) ** (1 / 3)
    x, q = grains(count, seed=3, box=edge, radius=RADIUS)
    v = np.random.default_rng(4).uniform(-0.1, 0.1, x.shape)
    head = [count, edge, 2 * RADIUS, 2500.0, 8e-6, 7.1e6, 4.6e6, 2e7, 0.3]
    np.concatenate([head, np.column_stack([x, v, q]).ravel()]).tofile(folder / "bed.bin")
    return edge, q


@pytest.mark.parametrize("ranks", [1, 2])
def test_beds_of_the_benchmark_run_and_state_their_errors(tmp_path, ranks):
    edge, q = bed(tmp_path, 216)
    # A tenth of a per cent of the mean force between neighbours
    force = 8.99e9 * np.mean(q**2) / (2.5 * RADIUS) ** 2 * 1e-3
    kinds = {"none": [], "pppm": [2.5e-3, 5, force, 1], "fix": [PLUGIN, 1e-2]}
    for kind, words in kinds.items():
        program = command(ranks, sys.executable, SCRIPT, "bed.bin", 40, 0.1, "states.bin", kind, *words)
        done = subprocess.run(
            program, cwd=tmp_path, capture_output=True, text=True, timeout=SECONDS, env=os.environ
        )
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
        lines = [[float(word) for word in line.split(",")] for line in done.stdout.splitlines() if line]
        assert sorted(line[1] for line in lines) == list(range(ranks))
        assert all(line[2] > 0 and line[3] > 0 for line in lines)
        if kind == "none":
            continue
        evaluations, stated = lines[0][4:]
        box, errors = ([0.0] * 3, [edge] * 3), []
        for state in np.fromfile(tmp_path / "states.bin").reshape(-1, 216, 7):
            exact = exact_field(tmp_path, state[:, :3], state[:, 3], box, ["p"] * 6, radius=RADIUS)
            errors.append(error(state[:, 4:], exact))
        true = np.sqrt(np.mean(np.square(errors)))
        if kind == "fix":
            assert 0 < evaluations < 0.5
            assert keeps_promise(true, stated, 1e-2)
        else:
            assert evaluations == 1 and stated == -1 and true < 3e-2

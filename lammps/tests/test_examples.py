# SPDX-License-Identifier: MIT
"""The examples, each with the number that it prints."""

import os
import re
import subprocess

import pytest
from support import BIN, EXAMPLES, PLUGIN, SECONDS, command, error, exact_field, keeps_promise, run


def printed(folder, example, ranks):
    """The last line of numbers that an example prints, by their headings."""
    program = command(ranks, BIN / "lmp", "-in", EXAMPLES / example, "-log", "none", "-var", "plugin", PLUGIN)
    done = subprocess.run(
        program, cwd=folder, capture_output=True, text=True, timeout=SECONDS, env=os.environ
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    table = re.search(r"^ *(Step .*?)^Loop time", done.stdout, re.DOTALL | re.MULTILINE).group(1)
    heading, *rows = [line.split() for line in table.splitlines() if "WARNING" not in line]
    return dict(zip(heading, map(float, rows[-1]), strict=True))


@pytest.mark.parametrize("ranks", [1, 2])
def test_capacitor_has_the_field_of_an_even_space_charge(tmp_path, ranks):
    row = printed(tmp_path, "in.capacitor", ranks)
    assert abs(row["v_low"] - 1) < 3e-3 and abs(row["v_high"] - 1) < 3e-3


@pytest.mark.parametrize("ranks", [1, 2])
def test_charged_bed_meets_its_tolerance_with_few_evaluations(tmp_path, ranks):
    row = printed(tmp_path, "in.charged-bed", ranks)
    assert 0 < row["f_E[1]"] < 1e-2
    assert row["f_E[3]"] < row["Step"] / 5


@pytest.mark.parametrize("ranks", [1, 2])
def test_drum_charges_its_grains_and_books_what_they_took(tmp_path, ranks):
    row = printed(tmp_path, "in.drum", ranks)
    assert abs(row["v_balance"]) < 1e-12
    # Impacts of a few bounces each: a twentieth of the steady charge.
    assert 0.03 < row["v_charged"] < 0.08


def test_field_of_the_bed_is_that_of_the_direct_sum_at_the_end(tmp_path):
    commands = (EXAMPLES / "in.charged-bed").read_text().replace("${plugin}", PLUGIN)
    end = run(
        tmp_path,
        [[commands.replace("boundary   p p f", "atom_modify map array\nboundary p p f"), "end"]],
        fixes=["E"],
        globals=[("stated", "E", 1)],
    )["end"]
    box = ([0.0, 0.0, 0.0], [0.003, 0.003, 0.006])
    places = end["x"] % [0.003, 0.003, 1.0]
    exact = exact_field(tmp_path, places, end["q"][:, 0], box, list("ppppgo"))
    assert keeps_promise(error(end["e"], exact), end["stated"], 1e-2)

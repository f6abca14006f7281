"""FMM3D in open space, and the accuracy that it reaches; CSV on stdout.

usage: fmm3d.py CLOUD PRECISIONS     (a list with commas)

CLOUD: as for lammps_field.py.
Every line: asked precision, measured relative RMS error of E, seconds (median of 3).
"""

import sys
import time

import fmm3dpy
import numpy


def main():
    data = numpy.fromfile(sys.argv[1])
    count = int(data[0])
    cloud = data[3:].reshape(count, 7)
    sources = numpy.asfortranarray(cloud[:, :3].T)
    charges = numpy.ascontiguousarray(cloud[:, 3])
    exact = cloud[:, 4:]
    scale = numpy.sqrt((exact**2).sum(axis=1).mean())
    for precision in map(float, sys.argv[2].split(",")):
        times = []
        for _ in range(3):
            start = time.perf_counter()
            out = fmm3dpy.lfmm3d(eps=precision, sources=sources, charges=charges, pg=2)
            times.append(time.perf_counter() - start)
        # FMM3D sums q/(4 pi r); E is minus the gradient of the sum of q/r.
        field = -4.0 * numpy.pi * out.grad.T
        error = numpy.sqrt(((field - exact) ** 2).sum(axis=1).mean()) / scale
        print(f"{precision},{error},{sorted(times)[1]}", flush=True)


main()

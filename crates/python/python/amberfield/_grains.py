"""Grains as arrays."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._errors import InputError

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes


@dataclass(repr=False)
class Grains:
    """Grains at one time, as arrays of equal length and order. What a file does not have is None."""

    #: Ids, shape (n,).
    id: NDArray[np.uint64]
    #: Centres [m], shape (n, 3).
    position_m: NDArray[np.float64]
    #: Velocities [m/s], shape (n, 3).
    velocity_m_s: NDArray[np.float64] | None = None
    #: Angular velocities [rad/s], shape (n, 3).
    angular_velocity_rad_s: NDArray[np.float64] | None = None
    #: Radii [m], shape (n,).
    radius_m: NDArray[np.float64] | None = None
    #: Densities [kg/m³], shape (n,).
    density_kg_m3: NDArray[np.float64] | None = None
    #: Charges [C], shape (n,).
    charge_C: NDArray[np.float64] | None = None
    #: Index of each grain's material in :attr:`materials`, shape (n,).
    material: NDArray[np.uint16] | None = None
    #: Names of the materials.
    materials: list[str] | None = None
    #: Time [s].
    time_s: float | None = None
    #: Step of the program that wrote the grains.
    step: int | None = None
    #: Corners of the box [m], shape (2, 3).
    box_m: NDArray[np.float64] | None = None
    #: Whether the box repeats along x, y and z.
    is_periodic: tuple[bool, bool, bool] | None = None

    def __len__(self) -> int:
        return len(self.id)

    def __repr__(self) -> str:
        known = [name for name in ("id", *_VECTORS, *_NUMBERS, "material") if getattr(self, name) is not None]
        when = "" if self.time_s is None else f" at t = {self.time_s:g} s"
        return f"<Grains: {len(self)}{when}, with {', '.join(known)}>"

    def columns(self) -> Iterator[tuple[str, NDArray[Any]]]:
        """Names and arrays of all columns that there are, vectors as one column for each component."""
        yield "id", self.id
        for name, column in _VECTORS.items():
            array = getattr(self, name)
            if array is not None:
                for axis, letter in enumerate("xyz"):
                    yield column.format(letter), array[:, axis]
        for name in _NUMBERS:
            array = getattr(self, name)
            if array is not None:
                yield name, array

    def write(self, path: str | os.PathLike[str], *, units: str = "si") -> None:
        """Write the grains in the form that the file's ending names: ``.csv``, ``.vtu``, ``.lammpstrj`` or
        ``.dump`` (text dump of LAMMPS), ``.data`` (data file of LAMMPS). What is None is left out.

        :param units: unit style of a file of LAMMPS
        :raises InputError: what the form lacks, or what is wrong with the arrays
        """
        count = len(self.id)
        grains: dict[str, Any] = {}
        for name in ("id", *_VECTORS, *_NUMBERS, "material"):
            array = getattr(self, name)
            if array is None:
                continue
            kind = {"id": np.uint64, "material": np.uint16}.get(name, np.float64)
            array = np.require(array, kind, "CA")
            shape = (count, 3) if name in _VECTORS else (count,)
            if array.shape != shape:
                raise InputError(f"{name}: its shape is {array.shape}, beside {count} ids; give {shape}")
            grains[name] = array
        grains |= {"step": self.step, "time_s": self.time_s, "materials": self.materials}
        if self.box_m is not None:
            grains["box_m"] = np.asarray(self.box_m, dtype=np.float64).tolist()
            grains["is_periodic"] = list(self.is_periodic or (False, False, False))
        _native.write_snapshot(os.fspath(path), units, grains)

    def to_pandas(self) -> pandas.DataFrame:
        """Table with a row for each grain and the columns of a particle file."""
        import pandas

        return pandas.DataFrame(dict(self.columns()))

    def plot(
        self,
        color: str | NDArray[np.float64] = "charge_C",
        *,
        plane: str = "xz",
        label: str | None = None,
        ax: Axes | None = None,
        **style: Any,
    ) -> Axes:
        """Draw the grains as discs of their size, seen along the third axis, the nearest in front.

        :param color: name of an array of numbers, or numbers of shape (n,)
        :param plane: two of x, y, z: the axes to the right and upwards
        :param label: text beside the scale of colours; None for that of the array
        :param ax: axes of matplotlib; None for new ones
        :param style: ``cmap``, ``norm``, ``clim`` and other properties of matplotlib's ``EllipseCollection``
        """
        from ._plots import plot_grains

        return plot_grains(self, color, plane, label, ax, style)

    def to_pyvista(self) -> Any:
        """Points of pyvista with all columns, to show with ``.glyph(scale="radius_m")`` or as they are."""
        from ._plots import pyvista

        points = pyvista().PolyData(np.ascontiguousarray(self.position_m))
        for name in ("id", *list(_VECTORS)[1:], *_NUMBERS):
            array = getattr(self, name)
            if array is not None:
                points.point_data[name] = array
        return points


#: Arrays of vectors, with the names of their columns.
_VECTORS = {
    "position_m": "{}_m",
    "velocity_m_s": "v{}_m_s",
    "angular_velocity_rad_s": "w{}_rad_s",
}
#: Arrays of numbers.
_NUMBERS = ("radius_m", "density_kg_m3", "charge_C")


def read(
    path: str | os.PathLike[str],
    *,
    units: str | None = None,
    step: int | None = None,
    materials_by_type: Sequence[str] = (),
) -> Grains:
    """Grains of a file at one time, whichever program wrote it: CSV and other tables of text, dumps of LAMMPS
    and LIGGGHTS, VTK, files of amberfield's runs; packed by gzip or not. Numbers are in SI units.

    :param path: file; its content tells what it is
    :param units: unit style of LAMMPS or LIGGGHTS in which a dump is, where it does not say so: ``"si"``,
        ``"cgs"``, ``"micro"``, ``"nano"``, ``"real"``, ``"metal"`` or ``"electron"``
    :param step: step of the frame in a file with several; None for the last
    :param materials_by_type: names of the materials of types 1, 2, …
    :raises InputError: what is wrong, and where
    """
    found = _native.read_snapshot(os.fspath(path), units, step, list(materials_by_type))
    if "box_m" in found:
        found["box_m"] = np.array(found["box_m"])
        found["is_periodic"] = tuple(found["is_periodic"])
    return Grains(**found)

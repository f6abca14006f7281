"""Grains as arrays."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._errors import InputError

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes


@dataclass
class Grains:
    """Grains at one time, as arrays of equal length and order."""

    #: Ids, shape (n,).
    id: NDArray[np.uint64]
    #: Centres [m], shape (n, 3).
    position_m: NDArray[np.float64]
    #: Velocities [m/s], shape (n, 3).
    velocity_m_s: NDArray[np.float64]
    #: Angular velocities [rad/s], shape (n, 3).
    angular_velocity_rad_s: NDArray[np.float64]
    #: Radii [m], shape (n,).
    radius_m: NDArray[np.float64]
    #: Densities [kg/m³], shape (n,).
    density_kg_m3: NDArray[np.float64]
    #: Charges [C], shape (n,).
    charge_C: NDArray[np.float64]
    #: Time [s]; None where it is not known.
    time_s: float | None = None
    #: Step of the run; None where it is not known.
    step: int | None = None

    def __len__(self) -> int:
        return len(self.id)

    def columns(self) -> Iterator[tuple[str, NDArray[Any]]]:
        """Names and arrays of all columns, vectors as one column for each component."""
        yield "id", self.id
        for name, array in (
            ("position_m", self.position_m),
            ("velocity_m_s", self.velocity_m_s),
            ("angular_velocity_rad_s", self.angular_velocity_rad_s),
        ):
            for axis, letter in enumerate("xyz"):
                yield _COMPONENT[name].format(letter), array[:, axis]
        for name in ("radius_m", "density_kg_m3", "charge_C"):
            yield name, getattr(self, name)

    def to_pandas(self) -> pandas.DataFrame:
        """Table with a row for each grain and the columns of a particle file."""
        import pandas

        return pandas.DataFrame(dict(self.columns()))

    def plot(self, color: str | NDArray[np.float64] = "charge_C", *, plane: str = "xz", ax: Axes | None = None, **style: Any) -> Axes:
        """Draw the grains as discs of their size, seen along the third axis, the nearest in front.

        :param color: name of an array of numbers, or numbers of shape (n,)
        :param plane: two of x, y, z: the axes to the right and upwards
        :param ax: axes of matplotlib; None for new ones
        :param style: ``cmap``, ``norm``, ``clim`` and other properties of matplotlib's ``EllipseCollection``
        """
        from ._plots import plot_grains

        return plot_grains(self, color, plane, ax, style)

    def to_pyvista(self) -> Any:
        """Points of pyvista with all columns, to show with ``.glyph(scale="radius_m")`` or as they are."""
        from ._plots import pyvista

        points = pyvista().PolyData(np.ascontiguousarray(self.position_m))
        for name in ("id", "velocity_m_s", "angular_velocity_rad_s", "radius_m", "density_kg_m3", "charge_C"):
            points.point_data[name] = getattr(self, name)
        return points


_COMPONENT = {
    "position_m": "{}_m",
    "velocity_m_s": "v{}_m_s",
    "angular_velocity_rad_s": "w{}_rad_s",
}

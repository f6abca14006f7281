"""Pictures by matplotlib, and by pyvista where it is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import InputError

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

    from ._grains import Grains

#: Words for the axis of a colour or a curve.
_LABELS = {
    "charge_C": "charge [C]",
    "radius_m": "radius [m]",
    "density_kg_m3": "density [kg/m³]",
}


def pyvista() -> Any:
    """Module pyvista."""
    try:
        import pyvista as module
    except ImportError:
        raise ImportError(
            "pyvista is not installed; install it with: pip install 'amberfield[pyvista]'"
        ) from None
    return module


def plot_grains(
    grains: Grains, color: Any, plane: str, label: str | None, ax: Axes | None, style: dict[str, Any]
) -> Axes:
    """Draw grains as discs of their size."""
    from matplotlib import pyplot
    from matplotlib.collections import EllipseCollection

    if len(plane) != 2 or plane[0] == plane[1] or not set(plane) <= set("xyz"):
        raise InputError(f"plane: got '{plane}'; give two of x, y, z, for example 'xz'")
    right, up = ("xyz".index(letter) for letter in plane)
    depth = 3 - right - up
    # Seen against the third axis of a right-handed frame: who is nearer is drawn later.
    towards = 1.0 if (right + 1) % 3 == up else -1.0
    order = np.argsort(towards * grains.position_m[:, depth], kind="stable")
    if grains.radius_m is None:
        raise InputError("the grains have no radius; set radius_m to numbers [m]")
    if label is None and isinstance(color, str):
        label = _LABELS.get(color, color)
    values = getattr(grains, color) if isinstance(color, str) else np.asarray(color)
    if values is None:
        raise InputError(f"color: the grains have no {color}; give numbers, or the name of another array")
    if values.shape != (len(grains),):
        raise InputError(
            f"color: its shape is {values.shape}; give one number for each of {len(grains)} grains"
        )

    if ax is None:
        _, ax = pyplot.subplots(layout="constrained")
    if "cmap" not in style and values.size and values.min() < 0.0 < values.max():
        bound = np.abs(values).max()
        style = {"cmap": "coolwarm", "clim": (-bound, bound), **style}
    clim = style.pop("clim", None)
    width = 2.0 * grains.radius_m[order]
    discs = EllipseCollection(
        width,
        width,
        np.zeros(len(grains)),
        units="xy",
        offsets=grains.position_m[order][:, (right, up)],
        offset_transform=ax.transData,
        array=values[order],
        **{"edgecolors": (0.0, 0.0, 0.0, 0.4), "linewidths": 0.4, **style},
    )
    if clim is not None:
        discs.set_clim(*clim)
    ax.add_collection(discs)
    margin = grains.radius_m.max() if len(grains) else 0.0
    for axis, set_limits in ((right, ax.set_xlim), (up, ax.set_ylim)):
        if len(grains):
            places = grains.position_m[:, axis]
            set_limits(places.min() - margin, places.max() + margin)
    ax.set_aspect("equal")
    ax.set_xlabel(f"{plane[0]} [m]")
    ax.set_ylabel(f"{plane[1]} [m]")
    # The scale is as high as the picture, whatever its form.
    ax.figure.colorbar(discs, cax=ax.inset_axes((1.02, 0.0, 0.03, 1.0)), label=label)
    if grains.time_s is not None:
        ax.set_title(f"t = {grains.time_s:g} s")
    return ax


def plot_history(history: pandas.DataFrame, columns: list[str] | None, ax: Axes | None) -> Axes:
    """Draw columns of a history over time."""
    from matplotlib import pyplot

    if columns is None:
        columns = [name for name in history.columns if name.endswith("_J")]
    unknown = [name for name in columns if name not in history.columns]
    if unknown:
        raise InputError(f"columns: there is no '{unknown[0]}'; the history has {', '.join(history.columns)}")
    if ax is None:
        _, ax = pyplot.subplots(layout="constrained")
    for name in columns:
        ax.plot(history["time_s"], history[name], label=name)
    ax.set_xlabel("time [s]")
    ax.legend()
    return ax

"""Runs: starting them, and reading what they wrote."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._errors import InputError
from ._grains import Grains
from ._scene_text import text_of
from ._vtu import arrays_of

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

PathLike = str | os.PathLike[str]

#: Arrays of a frame of the grains.
_OF_A_FRAME = (
    "id",
    "radius_m",
    "density_kg_m3",
    "charge_C",
    "velocity_m_s",
    "angular_velocity_rad_s",
    "material",
)


def run(
    scene: PathLike | Mapping[str, Any],
    out: PathLike | None = None,
    *,
    progress: bool = True,
    callback: Callable[[Grains], Any] | None = None,
    set: Mapping[str, Any] | None = None,
    steps: int | None = None,
    resume: PathLike | None = None,
    overwrite: bool = False,
    accept_changed_case: bool = False,
    threads: int | None = None,
) -> Run:
    """Simulate a scene and write its results, as ``amberfield run`` does.

    Python's other threads go on meanwhile. Ctrl-C stops the run after its step, with a checkpoint, and raises
    KeyboardInterrupt. There is one run at a time in a process. The log goes to the logger ``amberfield`` and
    to the file ``log.jsonl`` of the run.

    :param scene: scene file, or a dict with the keys of one; paths in a dict start in the current folder
    :param out: folder of the results; None for one named after the scene, or that of the checkpoint
    :param progress: whether to show a bar
    :param callback: function of the :class:`Grains` that were just written; it stops the run by returning
        False, and by an exception, which ``run`` raises
    :param set: overrides of keys, for example ``{"electric_field.tolerance": 1e-3}``
    :param steps: number of steps after which to stop
    :param resume: checkpoint from which to continue
    :param overwrite: whether to replace the results in the folder
    :param accept_changed_case: whether to continue though the OpenFOAM case has changed since the checkpoint
    :param threads: number of threads; None for all cores
    :raises InputError: what is wrong, and what to do
    :raises PeerError: a field solver that was lost
    :raises ToleranceError: results outside of the tolerance, which are written
    """
    path, text = "scene", None
    if isinstance(scene, Mapping):
        text = (text_of(scene), os.getcwd())
    else:
        path = os.fspath(scene)
    hear = None
    if callback is not None:

        def hear(step: int, time_s: float, arrays: dict[str, NDArray[Any]]) -> Any:
            return callback(Grains(**arrays, step=step, time_s=time_s))

    with _Bar(progress) as bar:
        folder, _ = _native.run(
            path,
            text,
            None if out is None else os.fspath(out),
            _overrides(set or {}),
            steps,
            None if resume is None else os.fspath(resume),
            overwrite,
            accept_changed_case,
            threads,
            hear,
            bar.show if progress else None,
        )
    return Run(folder)


class Run:
    """Results of a run, read from its folder as they are asked for."""

    def __init__(self, path: PathLike) -> None:
        self.path = Path(path)
        if not (self.path / "history.csv").is_file():
            raise InputError(f"{self.path}: no run folder: there is no history.csv in it")

    def __repr__(self) -> str:
        return f"Run({str(self.path)!r})"

    @property
    def history(self) -> pandas.DataFrame:
        """Rows of ``history.csv``: energies, charges, contacts and times."""
        return self._table("history.csv")

    @property
    def exits(self) -> pandas.DataFrame:
        """Rows of ``exits.csv``: grains that left."""
        return self._table("exits.csv")

    @property
    def wall_forces(self) -> pandas.DataFrame:
        """Rows of ``wall_forces.csv``: forces and torques on walls."""
        return self._table("wall_forces.csv")

    @property
    def charge_histogram(self) -> pandas.DataFrame:
        """Rows of ``charge_histogram.csv``: how charge spreads over the grains."""
        return self._table("charge_histogram.csv")

    @property
    def summary(self) -> dict[str, Any]:
        """Content of ``summary.json``: how the run ended, its energies, errors and times."""
        return json.loads((self.path / "summary.json").read_text(encoding="utf-8"))

    @property
    def scene(self) -> dict[str, Any]:
        """Scene of the run with all overrides, as a dict."""
        try:
            import tomllib
        except ImportError:
            import tomli as tomllib
        return tomllib.loads((self.path / "scene.toml").read_text(encoding="utf-8"))

    @property
    def log(self) -> list[dict[str, Any]]:
        """Lines of ``log.jsonl``."""
        text = (self.path / "log.jsonl").read_text(encoding="utf-8")
        return [json.loads(line) for line in text.splitlines()]

    @property
    def checkpoints(self) -> list[Path]:
        """Checkpoints, oldest first; one of them is what ``run(..., resume=...)`` takes."""
        return sorted((self.path / "checkpoints").glob("*.amber"))

    @property
    def times_s(self) -> NDArray[np.float64]:
        """Times of the files of the grains [s]."""
        return np.array([time for time, _ in self._frames("particles.pvd")])

    def __len__(self) -> int:
        """Number of files of the grains."""
        return len(self._frames("particles.pvd"))

    def grains(self, frame: int = -1) -> Grains:
        """Grains of a frame; -1 is the last."""
        time_s, path = self._frame("particles.pvd", frame)
        arrays = arrays_of(path)
        materials, box = _native.outline(str(self.path / "scene.toml"))
        grains = Grains(
            position_m=arrays["points_m"],
            **{name: arrays[name] for name in _OF_A_FRAME},
            materials=materials,
            time_s=time_s,
            step=int(path.stem.rsplit("_", 1)[1]),
        )
        if box is not None:
            corners, periodic = box
            grains.box_m, grains.is_periodic = np.array(corners), tuple(periodic)
        return grains

    def walls(self, frame: int = -1) -> pandas.DataFrame:
        """Charge on walls at a frame: a row for each charged place with the number of its wall, its centre,
        its charge, and the charge per area there.
        """
        import pandas

        _, path = self._frame("walls.pvd", frame)
        arrays = arrays_of(path)
        centres = arrays["points_m"].reshape(-1, 4, 3).mean(axis=1)
        columns = {"wall": arrays["wall"]}
        columns |= {f"{letter}_m": centres[:, axis] for axis, letter in enumerate("xyz")}
        columns |= {name: arrays[name] for name in ("charge_C", "charge_density_C_m2")}
        return pandas.DataFrame(columns)

    def plot(self, columns: str | Sequence[str] | None = None, *, ax: Axes | None = None) -> Axes:
        """Draw a column of the history over time, or several; None for all energies."""
        from ._plots import plot_history

        if isinstance(columns, str):
            columns = [columns]
        return plot_history(self.history, None if columns is None else list(columns), ax)

    def _table(self, name: str) -> pandas.DataFrame:
        import pandas

        path = self.path / name
        if not path.is_file():
            raise InputError(f"{path}: the run has written no such file; docs/files.md tells when it does")
        return pandas.read_csv(path)

    def _frames(self, series: str) -> list[tuple[float, Path]]:
        path = self.path / series
        if not path.is_file():
            raise InputError(
                f'{path}: the run has written no such file; set output.formats to have "vtk" in it'
            )
        sets = ElementTree.parse(path).getroot().iter("DataSet")
        return [(float(one.attrib["timestep"]), self.path / one.attrib["file"]) for one in sets]

    def _frame(self, series: str, frame: int) -> tuple[float, Path]:
        frames = self._frames(series)
        try:
            return frames[frame]
        except IndexError:
            raise InputError(
                f"frame {frame}: there are {len(frames)}; give 0 to {len(frames) - 1}, or -1"
            ) from None


class _Bar:
    """Bar of progress."""

    def __init__(self, wanted: bool) -> None:
        self._wanted = wanted
        self._bar: Any = None

    def __enter__(self) -> _Bar:
        return self

    def show(self, step: int, until: int, time_s: float) -> None:
        if self._bar is None:
            from tqdm.auto import tqdm

            self._bar = tqdm(total=until, initial=step, unit=" steps", mininterval=0.2)
        self._bar.set_postfix_str(f"t = {time_s:.4g} s", refresh=False)
        self._bar.update(step - self._bar.n)

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()


def _overrides(set: Mapping[str, Any]) -> list[str]:
    """Overrides as the command line has them."""
    overrides = []
    for key, value in set.items():
        if isinstance(value, Mapping):
            overrides += _overrides({f"{key}.{inner}": of_inner for inner, of_inner in value.items()})
        else:
            overrides.append(f"{key}={text_of({'value': value}).strip().removeprefix('value = ')}")
    return overrides

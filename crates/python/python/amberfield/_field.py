"""Electric field of charges."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._errors import InputError, ToleranceError
from ._scene_text import text_of

#: Condition on a face: ``"grounded"``, ``"insulating"``, ``"periodic"``, ``"open"``, ``{"potential_V":
#: 1000.0}`` or ``{"normal_field_V_m": 0.0}``.
Condition = str | Mapping[str, float]
#: Conditions on all faces: one for all, or one for each of ``x``, ``y``, ``z``, ``x_min``, ``x_max``, …
Faces = Condition | Mapping[str, Condition]

_AXES = ("x", "y", "z")
_ENDS = tuple(f"{axis}_{side}" for axis in _AXES for side in ("min", "max"))
_COMPONENTS = ("near", "middle", "far", "correction", "faces", "external")


@dataclass(repr=False)
class FieldValues:
    """Electric field at n charges."""

    #: Field [V/m], shape (n, 3).
    e: NDArray[np.float64]
    #: Potential [V], shape (n,); None where it was not asked for.
    potential: NDArray[np.float64] | None = None
    #: Parts of the field [V/m], each of shape (n, 3): near, middle, far, correction, faces, external. Empty
    #: where they were not asked for.
    components: dict[str, NDArray[np.float64]] = dataclass_field(default_factory=dict)
    #: Measured error: root mean square of the error of E over that of E. None for methods that make no
    #: promise.
    error: float | None = None
    #: Wall time of each stage [s].
    seconds: dict[str, float] = dataclass_field(default_factory=dict)

    def __repr__(self) -> str:
        error = "" if self.error is None else f", error {self.error:.2e}"
        return f"<FieldValues: E at {len(self.e)} charges{error}>"


class Field:
    """Electric field in a box, which keeps its parameters and its memory from one evaluation to the next.

    The parameters are chosen for the first charges, to meet the tolerance. Later charges may be elsewhere and
    of another number: :meth:`measure_error` tells the error for them.

    :param box: edge lengths [m], shape (3,), of a box with a corner at 0; or its two corners [m],
        shape (2, 3)
    :param faces: condition on all faces, or a dict of conditions for ``x``, ``y``, ``z``, or for single faces
        ``x_min``, ``x_max`` and so on
    :param tolerance: error of E that is allowed, relative to the root mean square of E
    :param method: ``"p3m"``, ``"direct"``, ``"kolehmainen"`` or ``"cutoff"``
    :param threads: number of threads; None for all cores
    :param settings: other keys of ``[electric_field]``, as ``amberfield keys electric_field`` lists them
    :raises InputError: what is wrong, and what to do
    """

    def __init__(
        self,
        box: ArrayLike,
        faces: Faces = "open",
        tolerance: float | None = None,
        *,
        method: str = "p3m",
        threads: int | None = None,
        **settings: Any,
    ) -> None:
        low, high = _corners(box)
        asked = {"method": method, **settings}
        if tolerance is not None:
            asked["tolerance"] = float(tolerance)
        domain = {"min_m": low, "max_m": high, "boundary": _boundary(faces)}
        try:
            self._native = _native.NativeField(text_of({"domain": domain, "electric_field": asked}))
        except InputError as error:
            raise InputError(_in_these_words(str(error))) from None
        self._threads = threads

    def __call__(
        self,
        positions: ArrayLike,
        charges: ArrayLike,
        *,
        potential: bool = True,
        components: bool = False,
    ) -> FieldValues:
        """Field at charges.

        :param positions: places [m], shape (n, 3); along periodic axes they may be outside of the box
        :param charges: charges [C], shape (n,)
        :param potential: whether the potential is wanted
        :param components: whether the parts of the field are wanted
        :raises InputError: values that are not finite, charges outside of the box, a net charge that no face
            takes
        """
        positions, charges = _charges(positions, charges)
        arrays = self._native.evaluate(positions, charges, potential, components, self._threads)
        return FieldValues(
            e=arrays["e"],
            potential=arrays.get("potential"),
            components={name: arrays[name] for name in _COMPONENTS if name in arrays},
            error=self._native.error_measured,
            seconds=dict(self._native.seconds),
        )

    def measure_error(self, positions: ArrayLike, charges: ArrayLike) -> float | None:
        """Relative root mean square error of E for these charges, on a sample; None for methods that make no
        promise and for sums that are exact. The field must have been evaluated once.
        """
        positions, charges = _charges(positions, charges)
        return self._native.measure_error(positions, charges, self._threads)

    @property
    def error(self) -> float | None:
        """Error that was measured last."""
        return self._native.error_measured

    @property
    def error_estimated(self) -> float | None:
        """Error that the model estimates for the parameters; None before the first charges."""
        return self._native.error_estimated

    @property
    def parameters(self) -> dict[str, Any] | None:
        """Parameters that were chosen; None before the first charges."""
        text = self._native.parameters
        return None if text is None else json.loads(text)


def field(
    positions: ArrayLike,
    charges: ArrayLike,
    box: ArrayLike,
    faces: Faces = "open",
    tolerance: float | None = None,
    *,
    method: str = "p3m",
    potential: bool = True,
    components: bool = False,
    threads: int | None = None,
    **settings: Any,
) -> FieldValues:
    """Electric field at charges in a box, with its measured error.

    :param positions: places [m], shape (n, 3)
    :param charges: charges [C], shape (n,)

    The other parameters are those of :class:`Field`. For the same box many times, a :class:`Field` is faster.

    :raises InputError: what is wrong, and what to do
    :raises ToleranceError: the error is above the tolerance; the field is in its attribute ``values``
    """
    made = Field(box, faces, tolerance, method=method, threads=threads, **settings)
    values = made(positions, charges, potential=potential, components=components)
    if values.error is None:
        values.error = made.measure_error(positions, charges)
    limit = made._native.tolerance
    if values.error is not None and limit is not None and values.error > limit:
        failure = ToleranceError(
            f"measured error {values.error:.2e} is above the tolerance {limit:g}; ask for a smaller "
            'tolerance or set tuning="timed"'
        )
        failure.values = values
        raise failure
    return values


def _charges(positions: ArrayLike, charges: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Arrays as the native half takes them; no copies where they are so already."""
    return _numbers("positions", positions, 2), _numbers("charges", charges, 1)


def _numbers(name: str, values: ArrayLike, dimensions: int) -> NDArray[np.float64]:
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "iufb":
            raise TypeError(f"its numbers are {array.dtype}")
        array = np.require(array, np.float64, "CA")
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: {error}; give an array of real numbers") from None
    if array.ndim != dimensions:
        shape = "(n, 3)" if dimensions == 2 else "(n,)"
        raise InputError(f"{name}: its shape is {array.shape}; give an array of shape {shape}")
    return array


def _corners(box: ArrayLike) -> tuple[list[float], list[float]]:
    """Lower and upper corner of a box."""
    try:
        array = np.asarray(box, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"box: {error}; give three edge lengths, or two corners") from None
    if array.shape == (3,):
        return [0.0, 0.0, 0.0], array.tolist()
    if array.shape == (2, 3):
        return array[0].tolist(), array[1].tolist()
    advice = "; its transpose has the right shape" if array.shape == (3, 2) else ""
    raise InputError(
        f"box: its shape is {array.shape}; give three edge lengths, shape (3,), or two corners, "
        f"shape (2, 3){advice}"
    )


def _in_these_words(message: str) -> str:
    """Message about keys of a scene in the words of the arguments that they were made of."""
    for pattern, word in (
        (r"the scene: ", ""),
        (r"\bdomain\.boundary\.(\w+)", r"faces['\1']"),
        (r"\bdomain\.boundary\b", "faces"),
        (r"\bdomain\.(min_m|max_m)\b", "box"),
        (r"\belectric_field\.", ""),
    ):
        message = re.sub(pattern, word, message)
    return message


def _boundary(faces: Faces) -> dict[str, Any]:
    """Table ``[domain.boundary]`` of conditions."""
    if isinstance(faces, Mapping) and not {"potential_V", "normal_field_V_m"} & set(faces):
        unknown = [key for key in faces if key not in _AXES and key not in _ENDS]
        if unknown:
            known = ", ".join((*_AXES, *_ENDS))
            raise InputError(f"faces: '{unknown[0]}' is no face; give a condition for some of {known}")
        table: dict[str, Any] = {}
        for key, condition in faces.items():
            if isinstance(condition, (tuple, list)):
                if key not in _AXES or len(condition) != 2:
                    raise InputError(
                        f"faces: {key}: give one condition, or for an axis a pair: lower face, upper face"
                    )
                table[f"{key}_min"], table[f"{key}_max"] = condition
            else:
                table[key] = condition
        return table
    return {axis: faces for axis in _AXES}

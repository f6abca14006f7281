from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

class NativeField:
    def __new__(cls, settings: str) -> NativeField: ...
    def evaluate(
        self,
        positions: NDArray[np.float64],
        charges: NDArray[np.float64],
        potential: bool,
        components: bool,
        thread_count: int | None,
    ) -> dict[str, NDArray[np.float64]]: ...
    def measure_error(
        self, positions: NDArray[np.float64], charges: NDArray[np.float64], thread_count: int | None
    ) -> float | None: ...
    @property
    def error_measured(self) -> float | None: ...
    @property
    def error_estimated(self) -> float | None: ...
    @property
    def tolerance(self) -> float | None: ...
    @property
    def parameters(self) -> str | None: ...
    @property
    def seconds(self) -> list[tuple[str, float]]: ...

def run(
    scene: str,
    text: tuple[str, str] | None,
    out: str | None,
    set: list[str],
    steps: int | None,
    resume: str | None,
    overwrite: bool,
    accept_changed_case: bool,
    thread_count: int | None,
    frame: Callable[[int, float, dict[str, NDArray[Any]]], Any] | None,
    progress: Callable[[int, int, float], Any] | None,
) -> tuple[str, list[str]]: ...
def read_snapshot(
    path: str, units: str | None, step: int | None, materials_by_type: list[str]
) -> dict[str, Any]: ...
def outline(
    scene: str,
) -> tuple[list[str], tuple[list[list[float]], tuple[bool, bool, bool]] | None]: ...
def write_snapshot(path: str, units: str, grains: dict[str, Any]) -> None: ...
def command(arguments: list[str]) -> int: ...

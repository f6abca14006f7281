"""Scenes as dicts: their text."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import tomli_w

from ._errors import InputError


def text_of(scene: Mapping[str, Any]) -> str:
    """TOML of a scene, whose values may be numpy's numbers and arrays, and paths."""
    return tomli_w.dumps({key: _plain(value, key) for key, value in scene.items()})


def _plain(value: Any, path: str) -> Any:
    """Value as TOML has it; ``path`` is its key in messages."""
    if isinstance(value, Mapping):
        return {key: _plain(inner, f"{path}.{key}") for key, inner in value.items()}
    if isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return _plain(value.tolist(), path)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Sequence):
        return [_plain(inner, f"{path}[{index}]") for index, inner in enumerate(value)]
    what = (
        "None; leave the key out"
        if value is None
        else f"a {type(value).__name__}; give a number, text, list or dict"
    )
    raise InputError(f"{path}: the value is {what}")

"""Arrays of the VTK files that a run writes: XML with raw appended data."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ._errors import InputError

_MARK = b'<AppendedData encoding="raw">\n_'
_TYPES = {"Float64": "<f8", "Int64": "<i8", "UInt64": "<u8", "UInt16": "<u2", "UInt8": "u1"}


def arrays_of(path: Path) -> dict[str, NDArray[Any]]:
    """All arrays of a file by their names; those of several components have a row for each entry."""
    data = path.read_bytes()
    at = data.find(_MARK)
    if at < 0:
        raise InputError(f"{path}: not a VTK file of a run: it has no raw appended data")
    head = ElementTree.fromstring(data[:at] + b"</VTKFile>")
    begin = at + len(_MARK)
    arrays = {}
    for array in head.iter("DataArray"):
        offset = begin + int(array.attrib["offset"])
        size = int(np.frombuffer(data, "<u8", 1, offset)[0])
        kind = np.dtype(_TYPES[array.attrib["type"]])
        # A copy, which is aligned and may be written to.
        values = np.frombuffer(data, kind, size // kind.itemsize, offset + 8).copy()
        components = int(array.attrib["NumberOfComponents"])
        arrays[array.attrib["Name"]] = values.reshape(-1, components) if components > 1 else values
    return arrays

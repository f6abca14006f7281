"""The electric field of charged grains, and the charge they trade on contact.

Units are SI. Positions have shape (n, 3). What is asked for wrongly raises :class:`InputError` with the text
that the command ``amberfield`` would print.

>>> import amberfield, numpy
>>> places = [[0.4, 0.5, 0.5], [0.6, 0.5, 0.5]]
>>> values = amberfield.field(places, [1e-9, -1e-9], box=[1, 1, 1], faces="grounded")
>>> values.e.shape
(2, 3)
"""

from ._errors import AmberfieldError, InputError, PeerError, ToleranceError
from ._field import Field, FieldValues, field
from ._grains import Grains, read
from ._run import Run, run
from ._version import __version__

__all__ = [
    "AmberfieldError",
    "Field",
    "FieldValues",
    "Grains",
    "InputError",
    "PeerError",
    "Run",
    "ToleranceError",
    "__version__",
    "field",
    "read",
    "run",
]

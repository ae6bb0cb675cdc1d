"""Saltus simulates and optimally controls dynamical systems that switch.

>>> import saltus
>>> m = saltus.catalogue("stick-slip")
>>> r = m.simulate(until=10)
>>> r.status
'completed'
"""

from __future__ import annotations

import pathlib as _pathlib

from . import _libraries

_libraries.load()

from . import _core  # noqa: E402
from ._errors import ModelError, ModelWarning, Stopped  # noqa: E402

_shared = _pathlib.Path(__file__).parent / "share"
if _shared.is_dir():
    _core.set_shared_folder(str(_shared))

from ._model import Model, catalogue, compare, models, order  # noqa: E402
from ._result import Event, Final, Result, Status, load  # noqa: E402

__version__: str = _core.version
__all__ = [
    "Event",
    "Final",
    "Model",
    "ModelError",
    "ModelWarning",
    "Result",
    "Status",
    "Stopped",
    "catalogue",
    "compare",
    "load",
    "models",
    "order",
]

"""Saltus simulates and optimally controls dynamical systems that switch.

>>> import saltus
>>> m = saltus.catalogue("stick-slip")
>>> r = m.simulate(until=10)
>>> r.status
'completed'
"""

from __future__ import annotations

import contextlib as _contextlib
import pathlib as _pathlib
import sys as _sys

from . import _libraries

_libraries.load()

from . import _core  # noqa: E402
from . import _casadi, _sympy  # noqa: E402, F401  (they say how expressions of these packages are read)
from ._errors import ModelError, ModelWarning  # noqa: E402

_shared = _pathlib.Path(__file__).parent / "share"
if _shared.is_dir():
    _core.set_shared_folder(str(_shared))

from ._array import Array, array  # noqa: E402
from ._builder import Builder  # noqa: E402
from ._catalogue import catalogue, compare, models, order  # noqa: E402
from ._difference import Difference, diff  # noqa: E402
from ._events import Alternative, Event, Events, Intersection  # noqa: E402
from ._expression import Expression  # noqa: E402
from ._functions import (  # noqa: E402
    abs,
    acos,
    asin,
    atan,
    atan2,
    cos,
    cosh,
    exp,
    floor,
    hypot,
    if_,
    initial,
    log,
    log10,
    max,
    min,
    mod,
    pi,
    pow,
    sign,
    sin,
    sinh,
    sqrt,
    step,
    t,
    tan,
    tanh,
)
from ._model import Model  # noqa: E402
from ._mpcc import Mpcc, mpcc  # noqa: E402
from ._outcome import Final, Intervals, Sensitivities, Status  # noqa: E402
from ._result import Result, Stopped, load  # noqa: E402
from ._sweep import Sweep  # noqa: E402

with _contextlib.suppress(AttributeError, KeyError):
    # TAB behind r.final[" asks for an attribute, which IPython does only where it knows that this has no effect.
    _policies = _sys.modules["IPython.core.guarded_eval"].EVALUATION_POLICIES
    _policies["limited"].allowed_getattr |= {Model, Result}

del annotations  # is no word of the package
__version__: str = _core.version
__all__ = [
    "Alternative",
    "Array",
    "Builder",
    "Difference",
    "Event",
    "Events",
    "Expression",
    "Final",
    "Intervals",
    "Intersection",
    "Model",
    "ModelError",
    "ModelWarning",
    "Mpcc",
    "Result",
    "Status",
    "Stopped",
    "Sensitivities",
    "Sweep",
    "array",
    "catalogue",
    "compare",
    "diff",
    "load",
    "models",
    "mpcc",
    "order",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "log",
    "log10",
    "sqrt",
    "pow",
    "hypot",
    "step",
    "sign",
    "abs",
    "max",
    "min",
    "floor",
    "mod",
    "initial",
    "if_",
    "t",
    "pi",
]

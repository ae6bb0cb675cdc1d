"""Values and keywords of Python as the settings of the tool."""

from __future__ import annotations

import numbers
import typing

import numpy as np

from . import _core
from ._errors import ModelError

Value = typing.Any  #: a number, a text (an expression, a word), a list of numbers, a dict of these
Option = tuple[str, str, str]
_SIMULATE = frozenset(_core.simulate_keys())
_OPTIMIZE = frozenset(_core.optimize_keys())


def text_of(value: Value) -> str:
    """A value as the tool reads it behind --set.

    >>> text_of(0.1), text_of(True), text_of([1, 2.5]), text_of("2*mu")
    ('0.1', 'true', '[1, 2.5]', '2*mu')
    """
    if isinstance(value, str):
        return value
    if value is None:
        return "none"
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return text_of(value.item())
    if is_list(value) or isinstance(value, np.ndarray):
        return "[" + ", ".join(text_of(entry) for entry in value) + "]"
    raise TypeError(f"a number, a text or a list of numbers is expected, found {type(value).__name__}")


def settings_of(values: typing.Mapping[str, Value] | None) -> list[str]:
    """NAME=VALUE of `set`; tables inside become dotted names."""
    if values is not None and not isinstance(values, typing.Mapping):
        raise TypeError(f'set={values!r}: expected a dict, e.g. set={{"mu": 0.5}}')
    return [f"{name}={text_of(value)}" for name, value in _flat(values or {})]


def _flat(values: typing.Mapping[str, Value], before: str = "") -> typing.Iterator[tuple[str, Value]]:
    for name, value in values.items():
        if isinstance(value, typing.Mapping):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def simulate_options(
    keywords: typing.Mapping[str, Value], method: str
) -> tuple[list[str], list[Option]]:
    """Settings and options of [simulate] that keywords stand for: `integrator` is event.integrator, `points` is
    output.points, `stages` is fesd.stages or, of the method timestepping, timestepping.stages."""
    keywords = {name.rstrip("_"): value for name, value in keywords.items() if value is not None}
    method = str(keywords.get("method", method))
    tables = ["output", "event", "smoothed", "timestepping" if method == "timestepping" else "fesd"]
    settings: list[str] = []
    options: list[Option] = []
    for name, value in _flat(keywords):
        if name.startswith("inputs."):
            settings.append(f"simulate.{name}={text_of(value)}")
            continue
        keys = [name] + [f"{table}.{name}" for table in tables]
        key = next((key for key in keys if key in _SIMULATE), name)
        options.append((f"simulate.{key}", text_of(value), f"{name}={_shown(value)}"))
    return settings, options


def optimize_options(keywords: typing.Mapping[str, Value]) -> tuple[list[str], list[Option]]:
    """The same of [optimize]: `tolerance` is mpcc.tolerance. Keys of the problem itself are settings."""
    settings: list[str] = []
    options: list[Option] = []
    for name, value in _flat({name.rstrip("_"): value for name, value in keywords.items() if value is not None}):
        key = next((key for key in (name, f"mpcc.{name}") if key in _OPTIMIZE), None)
        if key is None:
            settings.append(f"optimize.{name}={text_of(value)}")
        else:
            options.append((f"optimize.{key}", text_of(value), f"{name}={_shown(value)}"))
    return settings, options


def is_list(value: Value) -> bool:
    """Whether a keyword has several values."""
    if isinstance(value, (str, bytes, typing.Mapping)) or np.ndim(value) != 1:
        return False
    return isinstance(value, (typing.Sequence, np.ndarray)) or hasattr(value, "__array__")


def sweep_name(name: str, method: str) -> str:
    """What a keyword with several values changes: an option by its last word, else a name of the model."""
    ((key, _, _),) = simulate_options({name: 0}, method)[1]
    return key if key.removeprefix("simulate.") in _SIMULATE else name


def empty_axis(name: str) -> bool:
    """Refuses a list without values."""
    raise ModelError(f"{name}: an empty list of values", f"{name}: an empty list of values", "at least one value")


def _shown(value: Value) -> str:
    return repr(value) if isinstance(value, str) else text_of(value)


def check_path(value: typing.Any, what: str) -> None:
    """A mistake that is easily made: a text where a file is expected."""
    if isinstance(value, str) and "\n" in value:
        message, remedy = f"{what} expects the name of a file, found a text of several lines", "write saltus.Model.from_text(text)"
        raise ModelError(f"{message}; {remedy}", message, remedy)

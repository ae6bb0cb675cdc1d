"""Entries of a model file that a builder writes: words, points, samples, measurements; what is wrong is said at the call."""

from __future__ import annotations

import itertools
import math
import typing

import numpy as np

from . import _samples
from ._expression import Expression, is_foreign, refuse


def one_of(name: str, value: typing.Any, *words: str) -> typing.Any:
    """The word, if it is one of them; None is left to the model.

    >>> one_of("direction", "up", "up", "down")
    'up'
    """
    if value is not None and value not in words:
        raise refuse(f"{name}={value!r}: expected {', '.join(words[:-1])} or {words[-1]}", f'e.g. {name}="{words[0]}"')
    return value


def points(table: str, x: typing.Any, y: typing.Any, kind: str) -> dict[str, list[float]]:
    """The points of a table, which ascend and are as many as its kind needs.

    >>> points("road", [0, 1], [0, 0.5], "linear")
    {'x': [0.0, 1.0], 'y': [0.0, 0.5]}
    """
    if y is None:
        x, y = _columns(table, x)
    across, up = _numbers(table, x), _numbers(table, y)
    if len(across) != len(up):
        raise refuse(f"the table '{table}' has {len(across)} x and {len(up)} y", "every x needs its y")
    fewest = 4 if kind == "cubic" else 2
    if len(across) < fewest:
        raise refuse(f"the table '{table}' has {len(across)} points", f'kind="{kind}" needs at least {fewest}')
    for before, after in itertools.pairwise(across):
        if not after > before:
            raise refuse(f"the x of the table '{table}' must ascend, found {after} after {before}", "sort the points, each x once")
    return {"x": across, "y": up}


def _columns(table: str, points: typing.Any) -> tuple[typing.Any, typing.Any]:
    """The two columns of an array, a pair or a DataFrame."""
    if hasattr(points, "columns"):
        if len(points.columns) == 2:
            return points.iloc[:, 0], points.iloc[:, 1]
        raise refuse(
            f"the points of the table '{table}' are a DataFrame of {len(points.columns)} columns", "expected two: frame[['x', 'y']]"
        )
    if isinstance(points, np.ndarray) and points.ndim == 2 and points.shape[1] == 2:
        return points[:, 0], points[:, 1]
    if isinstance(points, (tuple, list)) and len(points) == 2 and np.ndim(points[0]) == 1:
        return points[0], points[1]
    raise refuse(f"the points of the table '{table}' are not clear", "give x and y, an array of two columns, or file=\"points.csv\"")


def _numbers(table: str, values: typing.Any) -> list[float]:
    try:
        numbers = [float(value) for value in values]
    except (TypeError, ValueError):
        raise refuse(f"the points of the table '{table}' are no lists of numbers", "e.g. [0, 1, 2]") from None
    for number in numbers:
        if not math.isfinite(number):
            raise refuse(f"the points of the table '{table}' have a {number}", "leave the point out")
    return numbers


Own = typing.Callable[[typing.Any], Expression]


def input_entry(name: str, value: typing.Any, own: Own) -> typing.Any:
    """What `inputs` has for a control."""
    what = f'the input of "{name}"'
    source = value.get("result") if isinstance(value, typing.Mapping) else value
    if hasattr(source, "optimization"):
        times, values = _samples.of_result(what, name, source)
    elif isinstance(value, typing.Mapping) and set(value) & {"file", "result"}:
        return dict(value)
    elif not isinstance(value, Expression) and not is_foreign(value) and _samples.is_data(value):
        times, values = _samples.samples(what, name, value)
    else:
        return own(value)
    return {"times": times, "values": values}


def least_squares(parts: typing.Any) -> typing.Any:
    """[[optimize.least_squares]] with references in memory written as rows: an array with a row for each interval, with
    `times` one for each of these; a pair (times, array); a DataFrame with a column for every expression, and t."""
    if not isinstance(parts, (list, tuple)):
        return parts
    return [_with_rows(part) if isinstance(part, typing.Mapping) else part for part in parts]


def _with_rows(part: typing.Mapping[str, typing.Any]) -> dict[str, typing.Any]:
    entry = dict(part)
    reference, times = entry.get("reference"), entry.pop("times", None)
    of = entry.get("of")
    names = [str(getattr(one, "text", one)) for one in (of if isinstance(of, (list, tuple, np.ndarray)) else [])]
    what = f"the reference of {', '.join(names) or 'least_squares'}"
    if isinstance(reference, tuple) and len(reference) == 2 and np.ndim(reference[0]) == 1:
        times, reference = reference
    if hasattr(reference, "columns"):
        if times is None and entry.get("at", "times") == "times":
            times = _samples.times_of_frame(what, reference)
    elif not (isinstance(reference, np.ndarray) and reference.ndim == 2 or times is not None or _is_matrix(reference)):
        return entry
    if reference is None:
        raise refuse(f"{what}: there are times and no reference", 'reference=array with a row for each of them')
    rows = _samples.rows(what, reference, len(names), names, times)
    entry["reference"] = {"rows": rows}
    if times is not None:
        if entry.get("at", "times") != "times":
            raise refuse(f"{what}: at={entry['at']!r} and times say twice where", 'leave one of them out')
        entry["at"] = "times"
    return entry


def _is_matrix(value: typing.Any) -> bool:
    return isinstance(value, (list, tuple)) and len(value) > 0 and isinstance(value[0], (list, tuple, np.ndarray))

"""What is wrong with a call of a builder, said at the call."""

from __future__ import annotations

import itertools
import math
import typing

from ._expression import refuse


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


def _numbers(table: str, values: typing.Any) -> list[float]:
    try:
        numbers = [float(value) for value in values]
    except (TypeError, ValueError):
        raise refuse(f"the points of the table '{table}' are no lists of numbers", "e.g. [0, 1, 2]") from None
    for number in numbers:
        if not math.isfinite(number):
            raise refuse(f"the points of the table '{table}' have a {number}", "leave the point out")
    return numbers

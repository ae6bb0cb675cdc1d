"""Names that stand for several: arrays of a builder, and patterns with stars."""

from __future__ import annotations

import re
import typing

import numpy as np

from ._expression import Expression

Names = np.ndarray[typing.Any, np.dtype[typing.Any]]


def several(name: typing.Any, known: typing.Collection[str]) -> Names | None:
    """The names that are meant by an array ("x" of x1, x2, …; or the array itself) or a pattern ("x*"), in its shape; None
    where there are none, and for a name that is known itself.

    >>> several("x", ["x1", "x2", "v"]).tolist(), several("T", ["T1_1", "T2_1"]).shape, several("x*", ["x1", "xa"]).tolist()
    (['x1', 'x2'], (2, 1), ['x1', 'xa'])
    """
    if isinstance(name, np.ndarray):
        return np.asarray(np.frompyfunc(str, 1, 1)(name)) if name.ndim > 0 else None
    text = name.text if isinstance(name, Expression) else name
    if not isinstance(text, str) or text in known:
        return None
    if "*" in text:
        pattern = re.compile(".*".join(map(re.escape, text.split("*"))), re.DOTALL)
        return _listed([one for one in known if pattern.fullmatch(one)])
    entry = re.compile(re.escape(text) + r"([1-9]\d*)(?:_([1-9]\d*))?")
    places = [tuple(int(i) for i in match.groups() if i) for match in map(entry.fullmatch, known) if match]
    for axes in (1, 2):
        found = {place for place in places if len(place) == axes}
        shape = tuple(max(along) for along in zip(*found))
        if found and len(found) == np.prod(shape):
            return entries(text, shape)
    return None


def entries(name: str, shape: tuple[int, ...]) -> Names:
    """The names of an array's entries: of one axis NAME1, NAME2, …; of two NAME1_1, NAME1_2, ….

    >>> entries("x", (2,)).tolist(), entries("T", (1, 2)).tolist()
    (['x1', 'x2'], [['T1_1', 'T1_2']])
    """
    names = np.empty(shape, dtype=object)
    for place in np.ndindex(*shape):
        names[place] = name + "_".join(str(i + 1) for i in place)
    return names


def _listed(names: list[str]) -> Names | None:
    return np.array(names, dtype=object) if names else None

"""Two results of a model: what differs, and how others are named in a page."""

from __future__ import annotations

import math
import os
import typing

from . import _core
from ._expression import refuse
from ._result import Result, as_result


class NumberDifference(typing.NamedTuple):
    """A number that differs: ``what`` it is ("x", "x at t = 2"), in ``a`` and in ``b``."""

    what: str
    a: float
    b: float


class Difference:
    """What differs between two results of a model; true if something does. ``print`` shows it as the tool does.

    ``parameters`` (which make no difference by themselves), ``end`` and ``rows`` (each state where it differs most) are
    lists of ``what``, ``a`` and ``b``; ``events`` the two numbers of events, ``first_event`` what differs in the first
    event that does, ``ends`` how the runs ended if differently.

    >>> m = saltus.catalogue("stick-slip")
    >>> d = saltus.diff(m.simulate(until=5), m.simulate(until=5, set={"belt": 0.1}))
    >>> d.same, d.parameters[0], d.events
    (False, NumberDifference(what='belt', a=0.2, b=0.1), (2, 1))
    """

    def __init__(self, found: dict[str, typing.Any]) -> None:
        self.same: bool = found["same"]
        self.parameters: list[NumberDifference] = [NumberDifference(*number) for number in found["parameters"]]
        self.end: list[NumberDifference] = [NumberDifference(*number) for number in found["end"]]
        self.rows: list[NumberDifference] = [NumberDifference(*number) for number in found["rows"]]
        self.events: tuple[int, int] = found["events"]
        self.first_event: str = found["first_event"]
        self.ends: str = found["ends"]
        self._text: str = found["text"]

    def __bool__(self) -> bool:
        return not self.same

    def __str__(self) -> str:
        return self._text.rstrip()

    def __repr__(self) -> str:
        *lines, verdict = str(self).splitlines()
        more = f"; {len(lines)} lines more: print(…)" if lines else ""
        return f"<saltus.Difference: {verdict}{more}>"


def diff(
    a: Result | str | os.PathLike[str],
    b: Result | str | os.PathLike[str],
    *,
    rtol: float = 1e-6,
    atol: float | None = None,
) -> Difference:
    """Says whether two results of a model are the same, to tolerances: ends, events, and rows at common times.

    `a` and `b` are results, or files of them. Without `atol` it is `rtol` times the range of each column, and no less than
    that with which the results were computed. Results of different models raise :class:`ModelError`.

    >>> m = saltus.catalogue("stick-slip")
    >>> saltus.diff(m.simulate(until=5), m.simulate(until=5, integrator="dop853"), rtol=1e-3).same
    True
    """
    for name, value in ("rtol", rtol), ("atol", atol):
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise refuse(f"{name}={value!r}: expected a number that is not negative", f"e.g. {name}=1e-6")
    return Difference(_core.difference(as_result(a).whole._run, as_result(b).whole._run, rtol, atol))

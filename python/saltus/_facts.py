"""What a result says beside its numbers over time."""

from __future__ import annotations

import functools
import json
import typing

import numpy as np

from ._columns import Array, Columns
from ._expression import refuse


class Quantities(dict[str, float]):
    """What a model or a result states, as a dict that is only read: a change is said where it is run.

    >>> m = saltus.catalogue("bouncing-ball")
    >>> m.parameters["e"], list(m.parameters)
    (0.9, ['g', 'e'])
    """

    def __init__(self, values: typing.Iterable[tuple[str, float]], remedy: str) -> None:
        """`remedy` says what to do instead of an assignment; ``{}`` in it stands for the name and the value."""
        super().__init__(values)
        self._remedy = remedy

    def __setitem__(self, name: str, value: float) -> typing.NoReturn:
        raise refuse(f"{name!r} cannot be assigned here", self._remedy.format(f'{{"{name}": {value!r}}}'))

    def __delitem__(self, name: str) -> typing.NoReturn:
        raise refuse(f"{name!r} cannot be removed here", "it is of the model, whose text states it")

    def update(self, *others: typing.Any, **values: typing.Any) -> typing.NoReturn:
        """Refused, as every change.

        >>> try:
        ...     saltus.catalogue("bouncing-ball").parameters.update(e=0.8)
        ... except saltus.ModelError as error:
        ...     print(error.remedy)
        change it in the call: m.simulate(set={"e": 0.8})
        """
        shown = ", ".join(f'"{name}": {value!r}' for name, value in dict(*others, **values).items())
        raise refuse("these values cannot be changed here", self._remedy.format(f"{{{shown}}}"))

    def _refused(self, *_: typing.Any) -> typing.NoReturn:
        raise refuse("these values cannot be changed here", "dict(…) of them is a dict of your own")

    setdefault = pop = popitem = clear = __ior__ = _refused

    def __reduce__(self) -> tuple[typing.Any, ...]:
        return Quantities, (list(self.items()), self._remedy)

    def __copy__(self) -> dict[str, float]:
        return dict(self)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)


def of_model(values: typing.Iterable[tuple[str, float]]) -> Quantities:
    """Those of a model."""
    return Quantities(values, "change it in the call: m.simulate(set={})")


def of_result(values: typing.Iterable[tuple[str, float]]) -> Quantities:
    """Those of a result, which happened."""
    return Quantities(values, "a result is what was computed; run the model again: m.simulate(set={})")


class Facts(Columns):
    """How a result was computed, and what is known of the run as a whole."""

    @functools.cached_property
    def _facts(self) -> dict[str, typing.Any]:
        """As in a stored result, without what has a row per time or event."""
        facts: dict[str, typing.Any] = json.loads(self._run.facts())
        return facts

    @property
    def _captions(self) -> dict[str, dict[str, str]]:
        """`unit` and `label` of columns that have them."""
        found: dict[str, dict[str, str]] = self._facts["model"].get("captions", {})
        return found

    @property
    def parameters(self) -> Quantities:
        """Parameters and the values they had.

        >>> saltus.catalogue("stick-slip").simulate(until=1, set={"belt": 0.3}).parameters
        {'belt': 0.3}
        """
        return of_result(self._run.parameters)

    @property
    def model(self) -> str:
        """The name of the model.

        >>> saltus.catalogue("stick-slip").simulate(until=1).model
        'stick-slip'
        """
        return self._run.model

    @property
    def method(self) -> str:
        """The method that ran.

        >>> saltus.catalogue("stick-slip").simulate(until=1, method="fesd", steps=10).method
        'fesd'
        """
        return self._run.method

    @property
    def options(self) -> dict[str, typing.Any]:
        """Every option in force, by its dotted name.

        >>> saltus.catalogue("stick-slip").simulate(until=1, rtol=1e-6).options["simulate.rtol"]
        1e-06
        """
        found: dict[str, typing.Any] = self._facts["options"]
        return found

    @property
    def statistics(self) -> dict[str, typing.Any]:
        """What it cost: ``steps``, ``rejected``, ``rhs_evaluations``, ``wall_seconds``; of an optimisation others.

        >>> saltus.catalogue("stick-slip").simulate(until=1).statistics["steps"] > 0
        True
        """
        found: dict[str, typing.Any] = self._facts["statistics"]
        return found

    @property
    def families(self) -> list[dict[str, typing.Any]]:
        """Continua of other solutions that no list of events can hold (docs/result-file.md).

        >>> family = saltus.catalogue("stay-or-leave").simulate().families[0]
        >>> family["kind"], family["event"]
        ('later_departure', 1)
        """
        found: list[dict[str, typing.Any]] = self._facts.get("families", [])
        return found

    @property
    def left_at(self) -> dict[str, typing.Any] | None:
        """Of a branch where it left: the number of the ``event`` of its parent, and which of its ``alternative``\\ s.

        >>> saltus.catalogue("part-ways").simulate(branches="all").branches[0].left_at
        {'event': 0, 'alternative': 0}
        """
        return self._facts.get("left_at")

    @property
    def contacts(self) -> list[str]:
        """Names of the contacts.

        >>> saltus.catalogue("falling-rod").simulate(until=1).contacts
        ['low', 'high']
        """
        return self._run.contacts

    @property
    def contact_modes(self) -> Array:
        """Words "open", "closed", "stick" and "slip", (rows, contacts).

        >>> saltus.catalogue("falling-rod").simulate(until=2).contact_modes[[0, -1]].tolist()
        [['open', 'open'], ['stick', 'stick']]
        """
        return np.array(self._run.contact_modes, dtype=str).reshape(-1, max(1, len(self.contacts)))[:, : len(self.contacts)]

    @property
    def date(self) -> str:
        """When it was computed, UTC: "2026-01-31T12:00:00Z"; "" if nobody noted it.

        >>> saltus.catalogue("stick-slip").simulate().date.endswith("Z")
        True
        """
        found: str = self._facts.get("date", "")
        return found

    @property
    def penetration(self) -> float | None:
        """With contacts: the largest depth of all rows, 0 without any.

        >>> round(saltus.catalogue("falling-rod").simulate(until=2).penetration, 12)
        0.0
        """
        return self._facts.get("penetration")

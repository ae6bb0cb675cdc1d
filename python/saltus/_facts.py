"""What a result says beside its numbers over time."""

from __future__ import annotations

import functools
import json
import typing

import numpy as np

from ._columns import Array, Columns


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
    def parameters(self) -> dict[str, float]:
        """Parameters and the values they had.

        >>> saltus.catalogue("stick-slip").simulate(until=1, set={"belt": 0.3}).parameters
        {'belt': 0.3}
        """
        return dict(self._run.parameters)

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

        >>> saltus.catalogue("falling-rod").simulate(until=2).penetration
        0.0
        """
        return self._facts.get("penetration")

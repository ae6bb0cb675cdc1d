"""What a run has computed, whatever ran it: events, end, optimum."""

from __future__ import annotations

import functools
import json
import typing

import numpy as np

from . import _core
from ._events import Events
from ._facts import Facts
from ._outcome import Final, Intervals, Kept, Sensitivities, Status

_OF_OPTIMUM = (
    "objective objective_terms horizon parameters u grid h speed_of_time multipliers homotopy starts certificate "
    "verification statistics"
).split()


class Recorded(Facts):
    """Rows, events, the end and the optimum of a run; what pictures and cards show."""

    def __init__(self, run: _core.Run, kept: Kept | None = None) -> None:
        """`kept` is what a sweep left of it."""
        super().__init__(run)
        self._kept = kept

    @functools.cached_property
    def events(self) -> Events:
        """All events, in their order; ``events.table()`` is a table of pandas.

        >>> r = saltus.catalogue("stick-slip").simulate(until=2)
        >>> r.events[0]
        <enter_sliding of slip at t = 0.244688802>
        """
        if self._lost_events:
            raise ValueError(
                f'events not kept; {self._lost_events} happened: sweep(…, keep="events") keeps them, r.whole.events has '
                "them of a single run, simulated once more"
            )
        return Events(self._run.events)

    @property
    def _lost_events(self) -> int:
        """How many events happened that are not here."""
        return self._kept.events if self._kept is not None and self._kept.what == "final" else 0

    @functools.cached_property
    def status(self) -> Status:
        """Why the run ended.

        >>> saltus.catalogue("stick-slip").simulate(until=1).status
        'completed'
        """
        return Status._of(self._run)

    @functools.cached_property
    def final(self) -> Final:
        """The end of the run.

        >>> saltus.catalogue("bouncing-ball").simulate(until=1).final
        <t = 1: y = 5.1, v = -9.8>
        """
        return Final(self._run)

    @functools.cached_property
    def sensitivities(self) -> Sensitivities | None:
        """Derivatives of the end state, if they were asked for (``method="fesd", sensitivities=True``).

        >>> r = saltus.catalogue("stick-slip").simulate(until=1, method="fesd", steps=10, sensitivities=True)
        >>> r.sensitivities.p.shape, r.sensitivities.parameters
        ((2, 1), ['belt'])
        """
        found = self._run.sensitivities
        if found is None:
            return None
        rows = len(self.states)
        return Sensitivities(
            np.array(found["x0"]).reshape(rows, -1), np.array(found["p"]).reshape(rows, -1), found["parameters"]
        )

    @functools.cached_property
    def _stored(self) -> dict[str, typing.Any]:
        stored: dict[str, typing.Any] = json.loads(self._run.json(False))
        return stored

    def to_dict(self) -> dict[str, typing.Any]:
        """Everything, as :meth:`save` writes it (docs/result-file.md).

        >>> saltus.catalogue("stick-slip").simulate(until=1, rtol=1e-6).to_dict()["options"]["simulate.rtol"]
        1e-06
        """
        stored: dict[str, typing.Any] = json.loads(self._run.json(True))
        return stored

    @property
    def optimization(self) -> dict[str, typing.Any] | None:
        """What an optimisation found beside the trajectory (docs/result-file.md); None of a simulation.

        ``objective``, ``horizon``, ``parameters``, ``u`` (rows are control intervals), ``grid``, ``multipliers``,
        ``homotopy``, ``certificate``, ``verification``, …

        >>> saltus.catalogue("stick-slip").simulate(until=1).optimization is None
        True
        """
        if self._run.command != "optimize":
            return None
        return {key: self._facts[key] for key in _OF_OPTIMUM if key in self._facts}

    @property
    def intervals(self) -> Intervals | None:
        """The controls that an optimisation found, interval by interval; None of a simulation.

        >>> saltus.catalogue("stick-slip").simulate(until=1).intervals is None
        True
        """
        found = self.optimization
        return None if found is None or "u" not in found else Intervals(found["grid"], found["u"], self.controls)

    @property
    def objective(self) -> float | None:
        """The value of the costs that an optimisation found; None of a simulation.

        >>> saltus.catalogue("stick-slip").simulate(until=1).objective is None
        True
        """
        return (self.optimization or {}).get("objective")

    @property
    def certificate(self) -> dict[str, typing.Any] | None:
        """What shows that an optimum is one: residuals, ``b_stationary``, … (docs/result-file.md); None of a simulation.

        >>> saltus.catalogue("stick-slip").simulate(until=1).certificate is None
        True
        """
        return (self.optimization or {}).get("certificate")

    @property
    def verification(self) -> dict[str, typing.Any] | None:
        """How the controls of an optimum do event by event: ``interval_defect``, ``open_loop``, … (docs/result-file.md);
        None of a simulation.

        >>> saltus.catalogue("stick-slip").simulate(until=1).verification is None
        True
        """
        return (self.optimization or {}).get("verification")

    @property
    def error_estimate(self) -> dict[str, typing.Any] | None:
        """Estimated errors, if they were asked for (``error_estimate=True``): ``x`` of every row and state,
        ``event_times``, ``final``, … (docs/result-file.md).

        >>> r = saltus.catalogue("bouncing-ball").simulate(until=1, error_estimate=True)
        >>> len(r.error_estimate["final"])
        2
        """
        return self._stored.get("error_estimate")

    @property
    def comparison(self) -> dict[str, typing.Any] | None:
        """The runs of :meth:`Model.compare`.

        >>> [run["method"] for run in saltus.catalogue("stick-slip").compare(until=1).comparison["runs"]][:1]
        ['event']
        """
        return self._stored.get("comparison")

    @property
    def order(self) -> dict[str, typing.Any] | None:
        """The series of :meth:`Model.order`.

        >>> study = saltus.catalogue("stick-slip").order(until=1, schemes=[("radau_iia", 2)], steps=[10, 20]).order
        >>> study["series"][0]["scheme"]
        'radau_iia'
        """
        return self._stored.get("order")

    def _reached(self, digits: int) -> str:
        """When it ended; an optimum that was not found ended at no time of its trajectory."""
        unsolved = self._run.command == "optimize" and not self.status.done
        return "" if unsolved else f" at t = {self.status.time_reached:.{digits}g}"

    @property
    def _several(self) -> str:
        """What it is of, if not of one run."""
        if self._run.command == "compare":
            return f"comparison of {len((self.comparison or {}).get('runs', []))} runs"
        return "errors of fixed steps" if self._run.command == "order" else ""

    @property
    def _counts(self) -> str:
        """How many events and rows there are."""
        if self._lost_events:
            return f"events not kept; {self._lost_events} happened"
        events, rows = _counted(len(self.events), "event"), _counted(len(self.t), "row")
        return f"{events}, " + (rows if self._rows_kept else "rows not kept")

    @property
    def _rows_kept(self) -> bool:
        return self._kept is None or self._kept.what == "trajectory"

    if not typing.TYPE_CHECKING:  # for who checks types there are only the attributes above

        def __getattr__(self, name):
            if name in _OF_OPTIMUM and self._run.command == "optimize":
                where = "r.intervals.ends" if name == "grid" else f'r.optimization["{name}"]'
                raise AttributeError(f"{name} is what an optimisation found: {where}")
            if not name.startswith("_") and name in self.names:
                raise AttributeError(f'{name} is a column of the result: r["{name}"]')
            raise AttributeError(f"a result has no attribute {name!r}")


def _counted(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"

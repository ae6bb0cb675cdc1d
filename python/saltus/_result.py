"""Results: what a run computed."""

from __future__ import annotations

import contextlib
import functools
import json
import os
import re
import typing

import numpy as np

from . import _card, _core, _data, _plot
from ._errors import ModelError, Stopped
from ._events import Event, Events
from ._expression import Expression, refuse
from ._facts import Facts
from ._outcome import Final, Kept, Sensitivities, Status

Array = np.ndarray[typing.Any, np.dtype[typing.Any]]


_OF_OPTIMUM = (
    "objective objective_terms horizon parameters u grid h speed_of_time multipliers homotopy starts certificate "
    "verification statistics"
).split()


#: The model, settings and options of a simulation, with which it can be run once more.
Again = tuple[typing.Any, list[str], list[tuple[str, str, str]]]
#: The same, what makes it, or the file of a result that has it.
Origin = typing.Union[Again, typing.Callable[[], Again], str, None]


class Result(Facts):
    """What a run computed: rows, events, the end, and why it ended.

    Arrays are read-only views of what the library holds. Every event has two rows of one time, before and behind it.

    >>> r = saltus.catalogue("stick-slip").simulate(until=10)
    >>> r["v"] is not None and r["v"].shape == r.t.shape
    True
    >>> r.x.flags.writeable
    False
    """

    def __init__(
        self, run: _core.Run, origin: Origin = None, kept: Kept | None = None, parent: tuple[Result, int] | None = None
    ) -> None:
        super().__init__(run)
        self._origin = origin
        self._kept = kept
        self._parent = parent  # of a branch: what it left, and which of its branches it is
        self._asked: tuple[Result, list[float], str] | None = None  # of values: what they are of, when, on which side

    @functools.cached_property
    def _again(self) -> Again | None:
        """How it can be run once more; of a stored simulation by the model in its file."""
        if callable(self._origin):
            return self._origin()
        if not isinstance(self._origin, str):
            return self._origin
        from ._model import Model

        try:
            return (Model(self._origin), [], []) if self._run.command == "simulate" else None
        except ModelError:
            return None

    @functools.cached_property
    def whole(self) -> Result:
        """All of a run of which a sweep kept a part only: it is simulated once more. Other results are whole already.

        >>> s = saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=5)
        >>> len(s.results[1].whole.events)
        2
        """
        if self._kept is None or self._again is None:
            return self
        model, settings, options = self._again
        return Result(model._core.simulate(settings, options, None, []), self._again)

    # What was computed ---------------------------------------------------------------------------------------------

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
    def branches(self) -> list[Result]:
        """Other motions that were followed (``branches="all"``), each with its own branches.

        >>> r = saltus.catalogue("stay-or-leave").simulate(branches="all")
        >>> len(r.branches) > 0
        True
        """
        return [Result(branch, parent=(self, number)) for number, branch in enumerate(self._run.branches)]

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

    # Between the rows ----------------------------------------------------------------------------------------------

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of the solution.

        >>> saltus.catalogue("stick-slip").simulate(until=2).span
        (0.0, 2.0)
        """
        return self._begin, float(self.status.time_reached)

    @functools.cached_property
    def _begin(self) -> float:
        """The first time; of a run whose rows were not kept that of its first step, taken once more."""
        if len(self.t):
            return float(self.t[0])
        if self._again is None:
            raise ValueError('the rows of this run were not kept: sweep(…, keep="trajectory") keeps them')
        model, settings, options = self._again
        first = [*options, ("simulate.max_steps", "1", "max_steps=1")]
        return float(model._core.simulate(settings, first, None, []).t[0])

    @functools.cached_property
    def _tree(self) -> _core.Run | None:
        """The same run with the polynomials of its steps, and those of its branches; None if it cannot be run again."""
        if self._run.is_continuous:
            return self._run
        if self._parent is not None:
            parent, number = self._parent
            return None if parent._tree is None else parent._tree.branches[number]
        if self._again is None:
            return None
        model, settings, options = self._again
        run: _core.Run = model._core.simulate_between(settings, options, True)
        return run

    @functools.cached_property
    def _between(self) -> _core.Run | None:
        """The same, of a root without its branches unless these are there."""
        if self._parent is not None or self._run.is_continuous or self._again is None or "_tree" in self.__dict__:
            return self._tree
        model, settings, options = self._again
        run: _core.Run = model._core.simulate_between(settings, options, False)
        return run

    def __call__(self, t: typing.Any, side: str = "right") -> Array:
        """The state at any time, or at several, from the polynomials of the steps; at an event `side` says which of both.

        The first call simulates the model once more and keeps these polynomials; with ``simulate(continuous=True)`` they
        are kept at once. Of one time an array (n_x,), of several (number, n_x).

        >>> r = saltus.catalogue("stick-slip").simulate(until=10)
        >>> r(0.5).shape, r([1, 2, 3]).shape
        ((2,), (3, 2))
        """
        values = self.at(t, side).x
        return values[0] if np.ndim(t) == 0 else values

    def at(self, t: typing.Any, side: str = "right") -> Result:
        """All columns at any times: a result with a row for each of them, in their order.

        >>> saltus.catalogue("stick-slip").simulate(until=10).at([1, 2])["v"].shape
        (2,)
        """
        if side not in ("left", "right"):
            raise ValueError(f"side={side!r}: expected 'left' or 'right', of an event at this time")
        try:
            times = np.atleast_1d(np.asarray(t, dtype=float)).ravel()
        except (TypeError, ValueError):
            raise ValueError(f"t={t!r}: expected a time, or a list of times") from None
        with own_results():
            if self._between is None:
                raise ValueError(
                    "this result has its rows only (it is one of several, an optimum from a file or with frozen time, or "
                    "its file has no model): simulate its model to have values at other times"
                )
            found = Result(self._run.values_at(self._between, times.tolist(), side == "left"))
            found._asked = self, times.tolist(), side
            return found

    # What to do with it --------------------------------------------------------------------------------------------

    def require(self) -> Result:
        """The result itself, if the run did what was asked; else raises :class:`Stopped`.

        >>> saltus.catalogue("stick-slip").simulate(until=1).require().status
        'completed'
        """
        if self.status.done:
            return self
        place = "" if "t = " in self.status.message else self._reached(17)
        reason = f": {self.status.message}" if self.status.message else ""
        raise Stopped(f"stopped early: {self.status}{place}{reason}", self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the result: ``.json`` all of it, ``.csv`` the trajectory, ``.events.csv`` the events, ``.npz`` both.

        >>> import tempfile, pathlib
        >>> file = pathlib.Path(tempfile.mkdtemp()) / "r.csv"
        >>> saltus.catalogue("stick-slip").simulate(until=1).save(file)
        >>> file.read_text().split(",")[0]
        't'
        """
        self.whole._run.save(os.fspath(path))

    def report(self, path: str | os.PathLike[str] | None = None, *, over: typing.Any = ()) -> Page | None:
        """Writes the page with all pictures, which works offline; without a path shows it in the notebook.

        `over` are other results of the model, or their files, which are laid over this one, with their differences:
        ``over=other``, ``over=["b.json", "c.json"]``, or a dict by the names in the page, ``over={"e = 0.7": other}``.

        >>> import tempfile, pathlib
        >>> file = pathlib.Path(tempfile.mkdtemp()) / "r.html"
        >>> saltus.catalogue("stick-slip").simulate(until=1).report(file)
        >>> file.exists()
        True
        """
        if path is not None and not os.fspath(path).lower().endswith((".html", ".htm")):
            raise refuse(f"{os.fspath(path)}: the name of a page must end in .html", "pictures for papers: r.plot()")
        from ._difference import laid_over

        page = self.whole._run.page(*laid_over(over))
        if path is None:
            return Page(page)
        _core.write_file(os.fspath(path), page)
        return None

    def plot(
        self,
        names: typing.Sequence[str | Expression] | None = None,
        axes: typing.Any = None,
        *,
        label: str | None = None,
        events: bool | None = None,
    ) -> typing.Any:
        """Draws columns over time (matplotlib): all states, controls and outputs, or those of `names`.

        Sliding is shaded, the two sides of a jump are not joined. What changes at events only, as discrete states, has
        steps with thin edges. Events are marked if they are at most 100: `events` marks all (True) or none (False).
        Returns the axes, one for every name; `axes` of a figure of your own, or of another result, are drawn into.
        `label` names it in a legend.

        >>> axes = saltus.catalogue("stick-slip").simulate(until=10).plot(["v"])
        >>> axes[0].get_ylabel()
        'v'
        """
        return _plot.plot(self, names, axes, label, events)

    def phase(
        self,
        x: str | Expression,
        y: str | Expression,
        axis: typing.Any = None,
        *,
        label: str | None = None,
        events: bool | None = None,
    ) -> typing.Any:
        """Draws one column over another (matplotlib); the line is thick where the solution slides. Returns the axes.

        Events are marked as by :meth:`plot`.

        >>> saltus.catalogue("stick-slip").simulate(until=10).phase("q", "v").get_xlabel()
        'q'
        """
        return _plot.phase(self, x, y, axis, label, events)

    def frame(self, grid: typing.Any = None) -> typing.Any:
        """A table of pandas, a row for every row of the result, with the time as its index.

        With `grid` a row for each of these times, or for so many at equal distances.

        >>> list(saltus.catalogue("stick-slip").simulate(until=10).frame().columns)
        ['q', 'v', 'mode(slip)', 'alpha(slip)']
        """
        return _data.frame(self, grid)

    def dataset(self, grid: typing.Any = None) -> typing.Any:
        """A data set of xarray: the columns over ``row``, with ``t`` as a coordinate. With `grid`, as that of
        :meth:`frame`, they lie over ``t``.

        >>> r = saltus.catalogue("stick-slip").simulate(until=1)
        >>> r.dataset()["v"].dims, r.dataset(grid=11)["v"].dims
        (('row',), ('t',))
        """
        return _data.dataset(self, grid)

    if not typing.TYPE_CHECKING:  # for who checks types there are only the attributes above

        def __getattr__(self, name):
            if name in _OF_OPTIMUM and self._run.command == "optimize":
                raise AttributeError(f'{name} is what an optimisation found: r.optimization["{name}"]')
            if not name.startswith("_") and name in self.names:
                raise AttributeError(f'{name} is a column of the result: r["{name}"]')
            raise AttributeError(f"a result has no attribute {name!r}")

    def _repr_html_(self) -> str:
        if self._several:
            return _card.table_card(f"{self.model}: {self._several}", self._run.table())
        return _card.card(self)

    def __repr__(self) -> str:
        if self._asked is not None:
            return f"<saltus.Result {self.model!r}: values at {len(self.t)} times>"
        if self._several:
            return f"<saltus.Result {self.model!r}: {self._several}; print(…) shows them>"
        return f"<saltus.Result {self.model!r}: {self.status}{self._reached(6)}, {self._counts}>"

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
        return f"{len(self.events)} events, " + (f"{len(self.t)} rows" if self._rows_kept else "rows not kept")

    @property
    def _rows_kept(self) -> bool:
        return self._kept is None or self._kept.what == "trajectory"

    def __str__(self) -> str:
        """The table of the tool; of values what they are."""
        if self._asked is not None:
            return repr(self)
        table = self._run.table()
        if not self._lost_events:
            return table
        return re.sub(r"(?m)^(events +)none$", rf"\1not kept; {self._lost_events} happened", table)

    def __reduce__(self) -> tuple[typing.Any, ...]:
        if self._asked is not None and self._asked[0]._again is not None:
            return Result.at, self._asked
        # What is simulated to be known is not simulated for that.
        costly = callable(self._origin) and not isinstance(self._origin, functools.partial)
        return _restored, (self._run.json(True), self._origin if costly else self._again, self._kept)


@contextlib.contextmanager
def own_results() -> typing.Iterator[None]:
    """What an exception (Ctrl-C) carries of an interrupted run becomes a result."""
    try:
        yield
    except BaseException as stopped:
        run = getattr(stopped, "result", None)
        if isinstance(run, _core.Run):
            stopped.result = Result(run)  # type: ignore[attr-defined]
        raise


class Page:
    """The page of a result, shown by a notebook."""

    def __init__(self, html: str) -> None:
        self.html = html

    def _repr_html_(self) -> str:
        import html

        return f'<iframe srcdoc="{html.escape(self.html)}" style="width:100%;height:720px;border:0"></iframe>'


def load(path: str | os.PathLike[str]) -> Result:
    """A result that was saved as .json. Of a simulation it has the model, too: ``r(t)`` runs it once more.

    >>> import tempfile, pathlib
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "r.json"
    >>> saltus.catalogue("stick-slip").simulate(until=1, output="steps").save(file)
    >>> saltus.load(file).final.t
    1.0
    """
    name = os.fspath(path)
    for suffix, reader in (".csv", "pandas.read_csv"), (".npz", "numpy.load"):
        if name.endswith(suffix):
            raise refuse(f"{name}: it has numbers only, no result", f'{reader}("{name}") reads it; r.save("r.json") keeps all')
    return Result(_core.load(name), os.path.abspath(path))


def _restored(text: str, origin: Origin = None, kept: Kept | None = None) -> Result:
    return Result(_core.parse_result(text), origin, kept)


def needed(package: str, extra: str) -> typing.Any:
    import importlib

    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise ImportError(f"this needs {package}: pip install 'saltus[{extra}]'") from error

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
from ._errors import Stopped
from ._events import Event, Events

Array = np.ndarray


_OF_OPTIMUM = (
    "objective objective_terms horizon parameters u grid h speed_of_time multipliers homotopy certificate "
    "verification statistics"
).split()


class Status(str):
    """Why a run ended, as a text: ``"completed"``, ``"iteration_limit"``, …; with the reason and what to try.

    ``done`` says whether it did what was asked, ``time_reached`` how far it came.
    """

    message: str
    time_reached: float
    done: bool

    @classmethod
    def of(cls, run: _core.Run) -> Status:
        status = cls(run.termination)
        status.message, status.time_reached, status.done = run.message, run.time_reached, run.done
        return status


class Final:
    """The end of a run: ``t``, ``x``, ``mode``, ``alpha``, and every value by its name, ``final["v"]``."""

    def __init__(self, run: _core.Run) -> None:
        values = run.final
        self.t: float = values["t"]
        self.x: Array = values["x"]
        self.mode: list[int] = values["mode"]
        self.alpha: Array = values["alpha"]
        self.outputs: Array = values["outputs"]
        self.regions: list[list[str]] = values["regions"]
        self._named = dict(zip(run.output_names, self.outputs.tolist()))
        self._named.update(zip(run.states, self.x.tolist()))

    def __getitem__(self, name: str) -> float:
        if name not in self._named:
            raise _unknown(name, list(self._named))
        return float(self._named[name])

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:.6g}" for name, value in self._named.items())
        return f"<t = {self.t:.6g}: {values}>"


class Sensitivities(typing.NamedTuple):
    """Derivatives of the end state by the initial state (``x0``) and by parameters (``p``); rows are states."""

    x0: Array
    p: Array
    parameters: list[str]


#: The model, settings and options of a simulation, with which it can be run once more.
Again = tuple[typing.Any, list[str], list[tuple[str, str, str]]]


class Kept(typing.NamedTuple):
    """What a sweep kept of a run ("final" or "events"), and how many events happened."""

    what: str
    events: int


class Result:
    """What a run computed: rows, events, the end, and why it ended.

    Arrays are read-only views of what the library holds. Every event has two rows of one time, before and behind it.

    >>> r = saltus.catalogue("stick-slip").simulate(until=10)
    >>> r["v"] is not None and r["v"].shape == r.t.shape
    True
    >>> r.x.flags.writeable
    False
    """

    def __init__(self, run: _core.Run, again: Again | None = None, kept: Kept | None = None) -> None:
        self._run = run
        self._again = again
        self._kept = kept

    # What was computed ---------------------------------------------------------------------------------------------

    @property
    def t(self) -> Array:
        """Times of all rows, ascending; two of one value at every event."""
        return self._run.t

    @property
    def x(self) -> Array:
        """States, (rows, n_x), in the order of ``states``; of a run with ``output={"states": …}`` only those."""
        return self._run.x

    @property
    def u(self) -> Array:
        """Controls, (rows, n_u)."""
        return self._run.u

    @property
    def alpha(self) -> Array:
        """Step selections, (rows, n_psi), in the order of ``switching_functions``; NaN where one is not determined."""
        return self._run.alpha

    @property
    def mode(self) -> Array:
        """Signs of the switching functions, (rows, n_psi); 0 while the solution slides on the surface."""
        return self._run.mode

    @property
    def outputs(self) -> Array:
        """[outputs] of the model, (rows, n_y)."""
        return self._run.outputs

    @property
    def states(self) -> list[str]:
        """Names of the states."""
        return self._run.states

    @property
    def controls(self) -> list[str]:
        """Names of the controls."""
        return self._run.controls

    @property
    def switching_functions(self) -> list[str]:
        """Names of the switching functions."""
        return self._run.switching_functions

    @property
    def output_names(self) -> list[str]:
        """Names of the outputs."""
        return self._run.output_names

    @property
    def parameters(self) -> dict[str, float]:
        """Parameters and the values they had."""
        return dict(self._run.parameters)

    @property
    def model(self) -> str:
        """The name of the model."""
        return self._run.model

    @property
    def method(self) -> str:
        """The method that ran."""
        return self._run.method

    def __getitem__(self, name: str) -> Array:
        """A column by its name: ``"t"``, a state, a control, an output, ``"alpha(slip)"`` or ``"mode(slip)"``."""
        columns = self._columns
        if not isinstance(name, str):
            raise TypeError(f"r[{name!r}]: a column is taken by its name, e.g. r['t']; a row of all states is r.x[i]")
        if name not in columns:
            raise _unknown(name, list(columns))
        block, index = columns[name]
        return self.t if index is None else getattr(self._run, block)[:, index]

    @property
    def names(self) -> list[str]:
        """All names of columns: ``t``, states, controls, outputs, modes and selections."""
        return list(self._columns)

    @functools.cached_property
    def _columns(self) -> dict[str, tuple[str, int | None]]:
        columns: dict[str, tuple[str, int | None]] = {"t": ("t", None)}
        for block, names in (
            ("x", self._run.states_in_rows),
            ("u", self.controls),
            ("outputs", self.output_names),
            ("mode", [f"mode({name})" for name in self._run.functions_in_rows]),
            ("alpha", [f"alpha({name})" for name in self._run.functions_in_rows]),
            ("theta", [f"theta({name})" for name in self._run.regions]),
        ):
            for index, name in enumerate(names):
                columns.setdefault(name, (block, index))
        return columns

    @functools.cached_property
    def events(self) -> Events:
        """All events, in their order; ``events.table()`` is a table of pandas.

        >>> r = saltus.catalogue("stick-slip").simulate(until=2)
        >>> r.events[0]
        <enter_sliding of slip at t = 0.244688802>
        """
        if self._lost_events:
            raise ValueError(
                f'events not kept; {self._lost_events} happened: sweep(…, keep="events") or keep="trajectory" keeps them'
            )
        return Events(self._run.events)

    @property
    def _lost_events(self) -> int:
        """How many events happened that are not here."""
        return self._kept.events if self._kept is not None and self._kept.what == "final" else 0

    @functools.cached_property
    def status(self) -> Status:
        """Why the run ended."""
        return Status.of(self._run)

    @functools.cached_property
    def final(self) -> Final:
        """The end of the run."""
        return Final(self._run)

    @functools.cached_property
    def branches(self) -> list[Result]:
        """Other motions that were followed (``branches="all"``), each with its own branches."""
        return [Result(branch) for branch in self._run.branches]

    @functools.cached_property
    def sensitivities(self) -> Sensitivities | None:
        """Derivatives of the end state, if they were asked for (``method="fesd", sensitivities=True``)."""
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
        """Everything, as :meth:`save` writes it (docs/result-file.md)."""
        stored: dict[str, typing.Any] = json.loads(self._run.json(True))
        return stored

    @property
    def optimization(self) -> dict[str, typing.Any] | None:
        """What an optimisation found beside the trajectory (docs/result-file.md); None of a simulation.

        ``objective``, ``horizon``, ``parameters``, ``u`` (rows are control intervals), ``grid``, ``multipliers``,
        ``homotopy``, ``certificate``, ``verification``, …
        """
        if self._run.command != "optimize":
            return None
        return {key: self._stored[key] for key in _OF_OPTIMUM if key in self._stored}

    @property
    def comparison(self) -> dict[str, typing.Any] | None:
        """The runs of :meth:`Model.compare`."""
        return self._stored.get("comparison")

    @property
    def order(self) -> dict[str, typing.Any] | None:
        """The series of :meth:`Model.order`."""
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

    def __call__(self, t: typing.Any, side: str = "right") -> Array:
        """The state at any time, or at several, from the polynomials of the steps; at an event `side` says which of both.

        The model is simulated once more with rows at these times: ask for many at once. Of one time an array (n_x,), of
        several (number, n_x).

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
        times = np.atleast_1d(np.asarray(t, dtype=float)).ravel()
        if self._again is None:
            raise ValueError(
                "this result has its rows only (it was loaded, optimised, or is one of several): simulate its model to "
                "have values at other times"
            )
        model, settings, options = self._again
        with own_results():
            return Result(model._core.values_at(self._run, settings, options, times.tolist(), side == "left"))

    # What to do with it --------------------------------------------------------------------------------------------

    def require(self) -> Result:
        """The result itself, if the run did what was asked; else raises :class:`Stopped`.

        >>> saltus.catalogue("stick-slip").simulate(until=1).require().status
        'completed'
        """
        if self.status.done:
            return self
        place = "" if "t = " in self.status.message else f" at t = {self.status.time_reached:.17g}"
        reason = f": {self.status.message}" if self.status.message else ""
        raise Stopped(f"stopped early: {self.status}{place}{reason}", self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the result: ``.json`` all of it, ``.csv`` the trajectory, ``.events.csv`` the events, ``.npz`` both."""
        self._run.save(os.fspath(path))

    def report(self, path: str | os.PathLike[str] | None = None) -> Page | None:
        """Writes the page with all pictures, which works offline; without a path shows it in the notebook."""
        page = self._run.page()
        if path is None:
            return Page(page)
        _core.write_file(os.fspath(path), page)
        return None

    def plot(self, names: typing.Sequence[str] | None = None, axes: typing.Any = None) -> typing.Any:
        """Draws columns over time (matplotlib): all states, controls and outputs, or those of `names`.

        Sliding is shaded, events are marked, the two sides of a jump are not joined. Returns the axes, one for every
        name; `axes` of a figure of your own are drawn into.

        >>> axes = saltus.catalogue("stick-slip").simulate(until=10).plot(["v"])
        >>> axes[0].get_ylabel()
        'v'
        """
        return _plot.plot(self, names, axes)

    def phase(self, x: str, y: str, axis: typing.Any = None) -> typing.Any:
        """Draws one column over another (matplotlib); the line is thick where the solution slides. Returns the axes.

        >>> saltus.catalogue("stick-slip").simulate(until=10).phase("q", "v").get_xlabel()
        'q'
        """
        return _plot.phase(self, x, y, axis)

    def frame(self, grid: typing.Any = None) -> typing.Any:
        """A table of pandas, a row for every row of the result, with the time as its index.

        With `grid` a row for each of these times, or for so many at equal distances.

        >>> list(saltus.catalogue("stick-slip").simulate(until=10).frame().columns)
        ['q', 'v', 'mode(slip)', 'alpha(slip)']
        """
        return _data.frame(self, grid)

    def dataset(self) -> typing.Any:
        """A data set of xarray: the columns over ``row``, with ``t`` as a coordinate."""
        return _data.dataset(self)

    def _repr_html_(self) -> str:
        return _card.card(self)

    def __repr__(self) -> str:
        return f"<saltus.Result {self.model!r}: {self.status} at t = {self.status.time_reached:.6g}, {self._counts}>"

    @property
    def _counts(self) -> str:
        """How many events and rows there are."""
        if self._lost_events:
            return f"events not kept; {self._lost_events} happened"
        return f"{len(self.events)} events, " + ("rows not kept" if self._kept else f"{len(self.t)} rows")

    def __str__(self) -> str:
        """The table of the tool."""
        table = self._run.table()
        if not self._lost_events:
            return table
        return re.sub(r"(?m)^(events +)none$", rf"\1not kept; {self._lost_events} happened", table)

    def __reduce__(self) -> tuple[typing.Any, ...]:
        return _restored, (self._run.json(True), self._again, self._kept)


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
    """A result that was saved as .json."""
    return Result(_core.load(os.fspath(path)))


def _restored(text: str, again: Again | None = None, kept: Kept | None = None) -> Result:
    return Result(_core.parse_result(text), again, kept)


def _unknown(name: str, known: list[str]) -> KeyError:
    import difflib

    near = difflib.get_close_matches(name, known, 3)
    hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"known: {', '.join(known)}"
    return KeyError(f"the result has no {name!r}; {hint}")


def needed(package: str, extra: str) -> typing.Any:
    import importlib

    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise ImportError(f"this needs {package}: pip install 'saltus[{extra}]'") from error

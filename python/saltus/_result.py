"""Results: what a run computed."""

from __future__ import annotations

import contextlib
import functools
import numbers
import os
import re
import typing

import numpy as np

from . import _card, _core, _data, _plot
from ._errors import ModelError, warn
from ._expression import Expression, refuse
from ._outcome import Kept
from ._recorded import Recorded

Array = np.ndarray[typing.Any, np.dtype[typing.Any]]


class Source:
    """What a model and the run of a stored result have in common: the model of the library."""

    _core: _core.Model
    _made: tuple[typing.Any, ...]

    def __reduce__(self) -> tuple[typing.Any, ...]:
        return self._made


def source_of_result(path: str) -> Source:
    """The model in the file of a result."""
    source = Source()
    source._core = _core.Model(path)
    source._made = (source_of_result, (path,))
    return source


#: The model, settings and options of a simulation, with which it can be run once more.
Again = tuple[Source, list[str], list[tuple[str, str, str]]]
#: The same, what makes it, or the file of a result that has it.
Origin = typing.Union[Again, typing.Callable[[], Again], str, None]


class Result(Recorded):
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
        super().__init__(run, kept)
        self._origin = origin
        self._parent = parent  # of a branch: what it left, and which of its branches it is
        self._asked: tuple[Result, list[float], str] | None = None  # of values: what they are of, when, on which side

    @functools.cached_property
    def _again(self) -> Again | None:
        """How it can be run once more; of a stored simulation by the model in its file."""
        if callable(self._origin):
            return self._origin()
        if not isinstance(self._origin, str):
            return self._origin
        try:
            return (source_of_result(self._origin), [], []) if self._run.command == "simulate" else None
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
    def branches(self) -> list[Result]:
        """Other motions that were followed (``branches="all"``), each with its own branches.

        >>> r = saltus.catalogue("stay-or-leave").simulate(branches="all")
        >>> len(r.branches) > 0
        True
        """
        return [Result(branch, parent=(self, number)) for number, branch in enumerate(self._run.branches)]

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
        if np.ndim(t) > 1:
            raise ValueError(f"t: expected a time, or a list of times, found an array of shape {np.shape(t)}")
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
        page = self.whole._run.page(*laid_over(over))
        if path is None:
            return Page(page)
        _core.write_file(os.fspath(path), page)
        return None

    @_plot.with_words
    def plot(
        self,
        names: typing.Sequence[typing.Any] | str | Expression | None = None,
        axes: typing.Any = None,
        *,
        ax: typing.Any = None,
        label: str | None = None,
        color: typing.Any = None,
        events: bool | None = None,
    ) -> typing.Any:
        """Draws columns over time (matplotlib): all states, controls and outputs, or those of `names`. What of these is a
        list, an array or a pattern is drawn into one picture, with a legend: ``[["x", "v"], "u"]``, ``["x*"]``.

        Sliding is shaded, the two sides of a jump are not joined. What changes at events only, as discrete states, has
        steps with thin edges. Events are marked if they are at most 100: `events` marks all (True) or none (False).
        Returns the axes, one for every name. `ax` are axes of a figure of your own, or of another result: as many, or one
        for everything. `label` names the result in a legend, `color` is that of its lines.

        >>> axes = saltus.catalogue("stick-slip").simulate(until=10).plot(["v"])
        >>> axes[0].get_ylabel()
        'v'
        """
        return _plot.plot(self._with_rows(2), names, _plot.axes_of(axes, ax), label, events, color)

    @_plot.with_words
    def phase(
        self,
        x: str | Expression,
        y: str | Expression,
        axis: typing.Any = None,
        *,
        ax: typing.Any = None,
        color: typing.Any = None,
        label: str | None = None,
        events: bool | None = None,
    ) -> typing.Any:
        """Draws one column over another (matplotlib); the line is thick where the solution slides. Returns the axes.

        Events are marked as by :meth:`plot`, of which `ax`, `label` and `color` are.

        >>> saltus.catalogue("stick-slip").simulate(until=10).phase("q", "v").get_xlabel()
        'q'
        """
        return _plot.phase(self._with_rows(2), x, y, _plot.axes_of(axis, ax), label, events, color)

    def frame(self, grid: typing.Any = None) -> typing.Any:
        """A table of pandas, a row for every row of the result, with the time as its index.

        With `grid` a row for each of these times, or for so many at equal distances.

        >>> list(saltus.catalogue("stick-slip").simulate(until=10).frame().columns)
        ['q', 'v', 'mode(slip)', 'alpha(slip)']
        """
        return _data.frame(self._on_grid(grid)._with_rows())

    def dataset(self, grid: typing.Any = None) -> typing.Any:
        """A data set of xarray: the columns over ``row``, with ``t`` as a coordinate. With `grid`, as that of
        :meth:`frame`, they lie over ``t``.

        >>> r = saltus.catalogue("stick-slip").simulate(until=1)
        >>> r.dataset()["v"].dims, r.dataset(grid=11)["v"].dims
        (('row',), ('t',))
        """
        return _data.dataset(self._on_grid(grid)._with_rows(), self.parameters, "row" if grid is None else "t")

    def _on_grid(self, grid: typing.Any) -> Result:
        """The result at the times of a grid, or at so many at equal distances; without one as it is."""
        if grid is None:
            return self
        if np.ndim(grid) == 0 and (not isinstance(grid, numbers.Integral) or grid < 2):
            raise ValueError(f"grid={grid!r}: expected a whole number of rows from 2 on, or a list of times")
        return self.at(np.linspace(*self.span, int(grid)) if np.ndim(grid) == 0 else grid)

    def _with_rows(self, least: int = 1) -> Result:
        """The result; a run of a sweep that kept no rows is simulated once more."""
        result = self if len(self.t) >= least else self.whole
        if len(result.t) < least:
            raise ValueError('this result has no trajectory: of a sweep ask for it with keep="trajectory"')
        return result

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


class Stopped(RuntimeError):
    """Raised by :meth:`Result.require` for a run that stopped early, and by sweeps and optimisations whose workers ended
    or cannot begin; ``result`` has what was computed.

    >>> import saltus
    >>> try:
    ...     saltus.catalogue("stick-slip").simulate(until=5, max_steps=9).require()
    ... except saltus.Stopped as stopped:
    ...     print(stopped.result.status)
    iteration_limit
    """

    def __init__(self, text: str, result: Result | None = None) -> None:
        super().__init__(text, result)
        self.result = result

    def __str__(self) -> str:
        return str(self.args[0])


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


def laid_over(over: typing.Any) -> tuple[list[str], list[_core.Run]]:
    """Names and runs of what a page lays over its own: a result or file, several, or a dict of them by their names."""
    several = [over] if isinstance(over, (Result, str, os.PathLike)) else over
    if isinstance(several, typing.Mapping):
        return [str(name) for name in several], [as_result(one).whole._run for one in several.values()]
    runs = [as_result(one).whole._run for one in several]
    names = [f"result {i}" if isinstance(one, Result) else os.path.basename(one) for i, one in enumerate(several, 2)]
    return names, runs


def as_result(one: typing.Any, what: str = "") -> Result:
    if isinstance(one, Result):
        return one
    if isinstance(one, (str, os.PathLike)):
        return load(one)
    raise refuse(f"{what}{type(one).__name__}: expected a result, or the file of one", 'e.g. r, or "r.json"')


def continued(
    start: typing.Any,
    states: typing.Mapping[str, float],
    parameters: typing.Mapping[str, float],
    set: typing.Mapping[str, typing.Any] | None,
    options: typing.Mapping[str, typing.Any],
    method: str,
    forced: typing.Container[str],
) -> tuple[dict[str, typing.Any], dict[str, typing.Any]]:
    """Settings and options of a run that begins with the states, the time and the modes at the end of `start`.
    `forced` are surfaces of which the model states a first mode.

    What is stated beside it stands in their place. Modes go on where nothing but the time is changed: of other
    parameters they are decided anew."""
    result = as_result(start, "start: ")
    if result.optimization is not None:
        raise refuse("start: an optimum is no run that goes on", "its end is set=r.final, its controls inputs={\"u\": r}")
    known = result.final.states()
    missing = [name for name in states if name not in known and "." not in name]  # those of contacts are decided anew
    if missing:
        raise refuse(
            f"start: the result of '{result.model}' has no state '{missing[0]}'",
            f"expected one of this model, found the states {', '.join(known)}",
        )
    settings = {**{name: known[name] for name in states if name in known}, **(set or {})}
    changed: dict[str, typing.Any] = {"from_": result.final.t, **options}
    stored = result.options
    # Periods of jumps count from the start of the first run; what was due at the end of the last one has happened.
    if "from_" not in options and str(options.get("method", method)) in ("event", "smoothed") and "simulate.from" in stored:
        begun = stored.get("simulate.begun", "none")
        changed.setdefault("begun", stored["simulate.from"] if begun == "none" else begun)
    names = result.switching_functions
    others = {name: value for name, value in result.parameters.items() if parameters.get(name, value) != value}
    others = {name: value for name, value in others.items() if name not in (set or {})}
    if others:
        shown = ", ".join(f"{name} = {value:.6g}" for name, value in others.items())
        kept = ", ".join(f'"{name}": {value!r}' for name, value in others.items())
        warn([f"start: the result was computed with {shown}, this run has the model's own; set={{{kept}}} keeps them"])
    goes_on = not set and not others and "from_" not in options and str(options.get("method", method)) == "event"
    if goes_on and result.method == "event" and "initial_mode" not in options and names:
        modes = {name: mode for name, mode in zip(names, result.final.mode) if mode == 0 or name in forced}
        if modes:
            changed["initial_mode"] = modes
    return settings, changed


def _restored(text: str, origin: Origin = None, kept: Kept | None = None) -> Result:
    return Result(_core.parse_result(text), origin, kept)

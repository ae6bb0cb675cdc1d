"""Many runs of one model, and their table."""

from __future__ import annotations

import dataclasses
import functools
import os
import shlex
import typing

import numpy as np

from . import _card, _core, _data, _sweep_plot
from ._errors import needed, warn
from ._expression import Expression, refuse
from ._names import several
from ._outcome import Kept, unknown
from ._result import Again, Origin, Result
from ._plot import axes_of, with_words
from ._settings import text_of

Array = np.ndarray[typing.Any, np.dtype[typing.Any]]

#: Columns, results, and the names of what was changed.
Found = tuple[dict[str, typing.Any], typing.Sequence[Result], list[str]]
#: The same as the library gives it.
FoundRuns = tuple[dict[str, typing.Any], list[_core.Run], list[str]]
#: What the library's sweep takes before its number of threads.
SweepArguments = tuple[
    list[str], list[tuple[str, str, str]], list[str], bool, list[str], typing.Optional[int], int, str, bool
]
#: A warning, and the numbers of the runs that it is about; none for all of them.
Warned = tuple[str, list[int]]
#: The place of ``keep`` among them.
_KEEP = 7


@dataclasses.dataclass(frozen=True)
class RunWithoutRow:
    """A run of which no row was kept that says its values. A share of the sweep that is this run alone, and keeps its
    end, says them when they are asked for."""

    model: typing.Any
    arguments: SweepArguments
    run: int
    runs: int

    def __call__(self) -> Again:
        of_end = (*self.arguments[:_KEEP], "final", *self.arguments[_KEEP + 1 :])
        columns, _, names = self.model._core.sweep(*of_end, 1, (self.run + 1, self.runs, 0), None, [])
        swept = [(name, columns[column]) for name, column in zip(names, list(columns)[1:])]
        return _again(self.model, self.arguments, swept, 0)


class Results(typing.Sequence[Result]):
    """The runs of a sweep as results that know how they can be run once more. Each is made when it is asked for."""

    def __init__(self, found: FoundRuns, model: typing.Any, arguments: SweepArguments, all_runs: bool = True) -> None:
        """`all_runs` is false of a part, where the number of a run does not say which one it is."""
        self._columns, self.runs, self._names = found
        self._model, self._arguments, self._all_runs = model, arguments, all_runs
        self._made: dict[int, Result] = {}

    def __len__(self) -> int:
        return len(self.runs)

    @typing.overload
    def __getitem__(self, index: int) -> Result: ...
    @typing.overload
    def __getitem__(self, index: slice) -> list[Result]: ...
    def __getitem__(self, index: int | slice) -> Result | list[Result]:
        if isinstance(index, slice):
            return [self._one(i) for i in range(*index.indices(len(self)))]
        return self._one(range(len(self))[index])

    def __repr__(self) -> str:
        return f"<{len(self)} results>"

    @functools.cached_property
    def _rows(self) -> Array:
        """Of every run its first row in the table; behind the last one their number."""
        keep = self._arguments[_KEEP]
        counts = [
            1 if keep == "final" else max(1, len(run.events)) if keep == "events" else len(run.t) for run in self.runs
        ]
        return np.concatenate([[0], np.cumsum(counts)]).astype(int)

    def _one(self, i: int) -> Result:
        if i not in self._made:
            run, keep, row = self.runs[i], str(self._arguments[_KEEP]), int(self._rows[i])
            swept = [(name, self._columns[column]) for name, column in zip(self._names, list(self._columns)[1:])]
            has_row = row < self._rows[i + 1]
            origin: Origin = None
            if has_row:
                origin = functools.partial(_again, self._model, self._arguments, swept, row)
            elif self._all_runs:
                origin = RunWithoutRow(self._model, self._arguments, i, len(self))
            events = int(self._columns["events"][row]) if keep == "final" else len(run.events)
            self._made[i] = Result(run, origin, Kept(keep, events))
        return self._made[i]

    def __reduce__(self) -> tuple[typing.Any, ...]:
        return list, (list(self),)


def with_results(found: FoundRuns, model: typing.Any, arguments: SweepArguments, all_runs: bool = True) -> Found:
    """What the library found, with its runs as results."""
    return found[0], Results(found, model, arguments, all_runs), found[2]


def _again(model: typing.Any, arguments: SweepArguments, swept: list[tuple[str, typing.Any]], row: int) -> Again:
    """How the run of a row is run once more: with the settings of the sweep, and its own values."""
    settings, options = arguments[:2]
    return model, [*settings, *(f"{name}={_text(column[row])}" for name, column in swept)], options


def _text(value: typing.Any) -> str:
    """A value of the table, as it was stated: whole numbers without a point."""
    whole = not isinstance(value, str) and value != 0 and abs(value) < 1e15 and value == int(value)
    return text_of(int(value) if whole else value)


def warn_of_runs(warned: list[Warned]) -> None:
    """Warns once of what several runs, or shares, have in common."""
    warn(_core.Model.told_with_runs(warned))


class Sweep:
    """All runs of a sweep: ``results[i]``, and one table of them.

    ``table`` has a column for the number of the run, for what was changed (``"v(0)"`` for the initial value of a state
    v), for the status, for whether the solution is unique (1; 0 if others are admissible; -1 if that was not decided),
    for the number of events of the run, and what was kept: values at the end, events (a run without one has a row whose
    ``event`` is 0), or rows of trajectories.

    >>> s = saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=5)
    >>> s
    <saltus.Sweep of 2 runs over belt: 2 completed>
    >>> list(s.table)
    ['run', 'belt', 'status', 'unique', 't', 'q', 'v', 'events']
    >>> s.results[1]
    <saltus.Result 'stick-slip': completed at t = 5, events not kept; 2 happened>
    """

    def __init__(
        self, found: Found, shape: tuple[int, ...], sampled: int, of: tuple[typing.Any, SweepArguments]
    ) -> None:
        """`sampled` is how many of the names, the last ones, had random values; `of` the model and what it was asked."""
        self._of = of
        self._columns, results, names = found
        self.results: typing.Sequence[Result] = results
        self.names: list[str] = names
        self._shape = shape
        self._sampled = sampled

    @functools.cached_property
    def table(self) -> dict[str, Array]:
        """All columns by their names, made when they are asked for: millions of words take seconds.

        >>> saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=5).table["status"].tolist()
        ['completed', 'completed']
        """
        return {name: as_column(name, values) for name, values in self._columns.items()}

    def __len__(self) -> int:
        return len(self.results)

    def __iter__(self) -> typing.Iterator[Result]:
        return iter(self.results)

    def __getitem__(self, name: str) -> Array:
        """A column of the table; of an array x1, x2, … ``"x"`` has those of all, and so has a pattern, ``"x*"``.

        >>> saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=5)["events"].tolist()
        [1, 2]
        """
        if isinstance(name, Expression):
            name = name.text
        if not isinstance(name, str):
            raise TypeError(f"s[{name!r}]: a column is taken by its name, e.g. s['run']; a run is s.results[{name!r}]")
        names = several(name, self.table)
        if names is not None:
            return np.stack([self.table[one] for one in names.flat], axis=-1).reshape(-1, *names.shape)
        if name not in self.table:
            raise unknown(name, list(self.table), "the table")
        return self.table[name]

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._columns)

    @property
    def done(self) -> bool:
        """Whether all runs did what was asked.

        >>> saltus.catalogue("stick-slip").sweep(max_steps=[3, 1000], until=5).done
        False
        """
        return all(run.done for run in self._runs)

    @property
    def _runs(self) -> list[_core.Run]:
        return self.results.runs if isinstance(self.results, Results) else [result._run for result in self.results]

    def parts(self) -> typing.Iterator[dict[str, Array]]:
        """The table part by part: of one in a folder (``resume=``) these are a thousand runs at most, else it is all.

        >>> [len(part["run"]) for part in saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=5).parts()]
        [2]
        """
        yield self.table

    def frame(self) -> typing.Any:
        """The table as one of pandas.

        >>> saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=5).frame()[["run", "belt", "events"]]
           run  belt  events
        0    1   0.1       1
        1    2   0.2       2
        """
        return needed("pandas", "data").DataFrame(dict(self.table))

    def dataset(self) -> typing.Any:
        """A data set of xarray: of a grid with its axes as dimensions, else over ``run``. Needs ``keep="final"``.

        >>> s = saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], q=[0, 0.1, 0.2], until=5)
        >>> s.dataset()["events"].dims
        ('belt', 'q(0)')
        """
        xarray = needed("xarray", "data")
        columns = dict(self.table)
        if len(columns["run"]) != len(self) or len(columns["run"]) and columns["run"][-1] != len(self):
            raise ValueError('a data set has a value for every run: sweep(..., keep="final")')
        swept = list(columns)[1 : 1 + len(self.names)]
        if len(self._shape) != len(swept) or int(np.prod(self._shape)) != len(self):
            coordinates = {"run": columns.pop("run"), **{name: ("run", columns.pop(name)) for name in swept}}
            return xarray.Dataset({name: ("run", values) for name, values in columns.items()}, coords=coordinates)
        coordinates = {}
        for axis, name in enumerate(swept):
            values = columns.pop(name).reshape(self._shape)
            coordinates[name] = np.moveaxis(values, axis, 0).reshape(self._shape[axis], -1)[:, 0]
        return xarray.Dataset(
            {name: (swept, values.reshape(self._shape)) for name, values in columns.items()}, coords=coordinates
        )

    @with_words
    def plot(
        self,
        name: str | Expression | None = None,
        over: str | None = None,
        axis: typing.Any = None,
        *,
        ax: typing.Any = None,
        label: str | None = None,
        color: typing.Any = None,
    ) -> typing.Any:
        """Draws a column of the table (matplotlib) over what was swept; of several, one line for each value of the
        others. `over` says what lies along the axis, without it what has the most values. Random samples are points, not
        joined by lines. Runs that stopped early are gaps, with a cross at the foot. Without a name all states and
        outputs at the end are drawn, each into axes of its own, which are returned; so are the entries of an array. `ax`
        are axes to draw into, `label` and `color` those of its lines. Needs ``keep="final"``.

        >>> s = saltus.catalogue("stick-slip").sweep(belt=np.linspace(0.1, 0.3, 5), q=[0, 0.1], until=5)
        >>> axis = s.plot("v")
        >>> axis.get_xlabel(), len(axis.lines)
        ('belt', 2)
        """
        axes, text = axes_of(axis, ax), None if name is None else str(name)
        names = several(text, self.table)
        if text is not None and names is None:
            return _sweep_plot.plot(self, text, over, axes, label, color)
        first = self.results[0]
        all_names = [*first.states, *first.output_names] if names is None else names.ravel().tolist()
        return _sweep_plot.plot_all(self, all_names, over, axes, label, color)

    @with_words
    def bifurcation(
        self,
        name: str | Expression,
        event: str | typing.Sequence[str] | None = None,
        after: float = -np.inf,
        over: str | None = None,
        axis: typing.Any = None,
        *,
        ax: typing.Any = None,
        label: str | None = None,
        color: typing.Any = None,
    ) -> typing.Any:
        """Draws a bifurcation diagram (matplotlib): a column at events, over what was swept, a point for each of them.

        `event` is the name of the events, their kind, or both the kind and the surface ("crossing slip"), or a list of
        these; without it all are drawn, each sort in its colour. `ax` are axes to draw into: what is drawn there before
        keeps its colour. `label` and `color` are those of the points. `after` is the time from which on, as transients are no part of it. Needs
        ``keep="events"``.

        >>> m = saltus.catalogue("stick-slip")
        >>> s = m.sweep(belt=np.linspace(0.1, 0.3, 5), until=40, keep="events")
        >>> s.bifurcation("q", event="leave_sliding", after=20).get_ylabel()
        'q at leave_sliding'
        """
        return _sweep_plot.bifurcation(self, str(name), event, after, over, axes_of(axis, ax), label, color)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the table as the tool does: ``.csv``, or ``.npz`` with an array for every column.

        >>> import tempfile, pathlib
        >>> file = pathlib.Path(tempfile.mkdtemp()) / "s.csv"
        >>> saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=5).save(file)
        >>> file.read_text().splitlines()[0]
        'run,belt,status,unique,t,q,v,events'
        """
        name = os.fspath(path)
        if name.endswith(".csv"):
            _core.write_file(name, _data.csv(self._columns))
        elif name.endswith(".npz"):
            _data.write_arrays(name, self.table)
        else:
            raise refuse(f"{name}: the name must end in .csv or .npz", 's.save("s.csv")')

    def report(self, path: str | os.PathLike[str]) -> None:
        """Writes the page of ``saltus sweep --report``: lines or maps of the table, which works offline.

        >>> import tempfile, pathlib
        >>> page = pathlib.Path(tempfile.mkdtemp()) / "s.html"
        >>> saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=5).report(page)
        >>> "<svg" in page.read_text() or "createElementNS" in page.read_text()
        True
        """
        columns: list[tuple[str, list[str], list[float]]] = []
        for name, values in self._columns.items():
            listed = np.asarray(values).tolist()
            words = bool(listed) and isinstance(listed[0], str)
            columns.append((name, listed if words else [], [] if words else listed))
        model, (settings, options, _, paired, samples, *_) = self._of
        values_of_all = [*settings, *(f"{key}={value}" for key, value, _ in options)]
        command = shlex.join(["saltus", "simulate", model.path, *(f"--set={value}" for value in values_of_all)])
        page = model._core.sweep_page(columns, self.names, command, not paired and not samples)
        _core.write_file(os.fspath(path), page)

    def _repr_html_(self) -> str:
        return _card.sweep_card(self)

    def __repr__(self) -> str:
        counts: dict[str, int] = {}
        for run in self._runs:
            counts[run.termination] = counts.get(run.termination, 0) + 1
        statuses = ", ".join(f"{count} {status}" for status, count in sorted(counts.items()))
        of_runs = dict(zip(self._columns["run"], self._columns["unique"]))
        others = sum(value == 0 for value in of_runs.values())
        doubt = f"; {others} not unique" if others else ""
        return f"<saltus.Sweep of {len(self)} runs over {', '.join(self.names)}: {statuses}{doubt}>"


def as_column(name: str, values: typing.Any) -> Array:
    """Numbers of runs, of events and of modes are whole, and so is whether a solution is unique."""
    column = np.asarray(values)
    counts = name in ("run", "event", "events", "unique") or name.startswith("mode(")
    if counts and column.dtype == float and np.all(np.mod(column, 1) == 0):
        return column.astype(np.int64)
    return column

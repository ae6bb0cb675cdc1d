"""A sweep whose table lies in a folder: rows of any number of runs, of which one part is in memory at a time."""

from __future__ import annotations

import collections
import contextlib
import os
import typing

import numpy as np

from .. import _core, _data
from .._result import Result, Stopped
from ._shares import MOST_RUNS, Cutter, Place, Shares, Tell, run_share, stop_file
from .._sweep import Array, RunWithoutRow, Sweep, SweepArguments, Warned, as_column, warn_of_runs
from ._sweep_folder import Folder, Part, Statement
from ._tasks import Tasks, Workers

#: Of a small sweep, which has a part for each of its runs if there are no more.
_LEAST_PARTS = 64
#: Files of one folder.
_MOST_PARTS = 10_000
#: Runs of a warning that are remembered.
_MOST_WARNED = 10_000

#: Whether all runs are done, how many are not unique, how many have which status.
Tally = tuple[bool, int, dict[str, int]]
#: Columns, what the runs came to, warnings, whether the share is whole.
Rows = tuple[dict[str, typing.Any], Tally, list[Warned], bool]
#: Shape of a grid, and how many names have random values.
Axes = tuple[tuple[int, ...], int]


class StoredRuns(typing.Sequence[Result]):
    """The runs of a folder. Each is simulated again, as a whole, when it is asked for."""

    def __init__(self, parts: list[Part], runs: int, model: typing.Any, arguments: SweepArguments) -> None:
        self._parts, self._runs, self._model, self._arguments = parts, runs, model, arguments

    def __len__(self) -> int:
        return sum(part.last - part.first + 1 for part in self._parts)

    @typing.overload
    def __getitem__(self, index: int) -> Result: ...
    @typing.overload
    def __getitem__(self, index: slice) -> list[Result]: ...
    def __getitem__(self, index: int | slice) -> Result | list[Result]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        left = range(len(self))[index]
        for part in self._parts:
            here = part.last - part.first + 1
            if left < here:
                again = RunWithoutRow(self._model, self._arguments, part.first - 1 + left, self._runs)()
                model, settings, options = again
                return Result(model._core.simulate(settings, options, None, []), again)
            left -= here
        raise IndexError(index)

    def __repr__(self) -> str:
        return f"<{len(self)} results, simulated again when they are asked for>"


class StoredColumns(typing.Mapping[str, Array]):
    """Columns of all parts, each read when it is asked for."""

    def __init__(self, folder: Folder) -> None:
        self._folder, self._parts = folder, folder.ordered
        # Parts may have different columns: of a run that has no switching function of a name there is no mode.
        sets: dict[tuple[str, ...], tuple[str, ...]] = {}
        headings = [tuple(folder.columns(part)) for part in self._parts]
        self._of_parts = [sets.setdefault(names, names) for names in headings]
        self._names = dict.fromkeys(name for names in sets for name in names) if self._parts else {"run": None, "unique": None}

    def __getitem__(self, name: str) -> Array:
        if name not in self._names:
            raise KeyError(name)
        if not self._parts:
            return np.zeros(0)
        pieces = [
            self._folder.read(part, [name])[name] if name in names else None
            for part, names in zip(self._parts, self._of_parts)
        ]
        return as_column(name, _data.stacked(pieces, [part.rows for part in self._parts]))

    def parts(self) -> typing.Iterator[dict[str, Array]]:
        """All columns of every part, of which some may be gaps."""
        for part in self._parts:
            found = self._folder.read(part)
            gaps = {name: np.full(part.rows, np.nan) for name in self._names if name not in found}
            yield {name: as_column(name, found.get(name, gaps.get(name))) for name in self._names}

    def __contains__(self, name: object) -> bool:
        return name in self._names  # without reading it

    def __iter__(self) -> typing.Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class StoredSweep(Sweep):
    """What ``m.sweep(…, resume=folder)`` gives: the table of the folder, with all that a :class:`Sweep` has.

    A column is read when it is asked for, ``parts()`` goes through the table in bounded memory, and a run of ``results``
    is simulated again, as a whole.
    """

    def __init__(self, folder: Folder, axes: Axes, of: tuple[typing.Any, SweepArguments]) -> None:
        self._folder, self._parts = folder, folder.ordered
        runs = StoredRuns(self._parts, folder.statement.runs, *of)
        columns = typing.cast("dict[str, typing.Any]", StoredColumns(folder))
        super().__init__((columns, runs, list(folder.statement.names)), *axes, of)

    @property
    def table(self) -> typing.Any:
        """All columns by their names, each read when it is asked for."""
        return self._columns

    def parts(self) -> typing.Iterator[dict[str, Array]]:
        """The table part by part, a thousand runs at most each: for more rows than the memory holds."""
        return typing.cast(StoredColumns, self._columns).parts()

    @property
    def done(self) -> bool:
        """Whether all runs of the sweep are there and did what was asked."""
        return len(self) == self._folder.statement.runs and all(part.done for part in self._parts)

    def __repr__(self) -> str:
        counts: collections.Counter[str] = collections.Counter()
        for part in self._parts:
            counts.update(part.statuses)
        statuses = ", ".join(f"{count} {status}" for status, count in sorted(counts.items()))
        others = sum(part.others for part in self._parts)
        doubt = f"; {others} not unique" if others else ""
        asked = self._folder.statement.runs
        of = "" if len(self) == asked else f" of {asked}"
        return f"<saltus.Sweep of {len(self)}{of} runs over {', '.join(self.names)}, in {self._folder.path}: {statuses}{doubt}>"

    def __reduce__(self) -> typing.Any:
        raise TypeError(f"this sweep is the folder {self._folder.path}: send its name")


def rows_of(model: typing.Any, arguments: SweepArguments, jobs: int, share: Place, stop: str) -> Rows:
    """The rows of one share, without results: they are what is stored."""
    (columns, runs, _), warned, complete = run_share(model, arguments, jobs, share, stop)
    return columns, tally_of(columns, runs), warned, complete


def tally_of(columns: typing.Mapping[str, typing.Any], runs: list[_core.Run]) -> Tally:
    """What runs came to."""
    numbers, unique = np.asarray(columns.get("run", ())), np.asarray(columns.get("unique", ()))
    first = np.append(True, np.diff(numbers) != 0)[: len(numbers)]
    statuses = collections.Counter(run.termination for run in runs)
    return all(run.done for run in runs), int(np.count_nonzero(unique[first] == 0)), dict(statuses)


def sweep_into(
    folder: str | os.PathLike[str],
    executor: typing.Any,
    model: typing.Any,
    arguments: SweepArguments,
    jobs: int | None,
    tell: Tell | None,
    axes: Axes,
) -> StoredSweep:
    """Computes the parts that the folder lacks. `result` of an interruption, or of :class:`Stopped`, has what is there."""
    mark, runs = model._core.study(*arguments)
    parts = min(max(-(-runs // MOST_RUNS), min(runs, _LEAST_PARTS)), _MOST_PARTS)
    names = tuple(entry.partition("=")[0] for entry in (*arguments[2], *arguments[4]))
    into = Folder(folder, Statement(mark, runs, parts, names))
    warned: dict[str, set[int]] = {}
    with contextlib.closing(into):
        cutter = Cutter(arguments, runs, into.statement.parts)
        if tell is not None:
            tell(into.runs, runs)
        try:
            if executor is None:
                _fill(into, cutter, model, jobs or 0, tell, warned)
            else:
                _fill_by(executor, into, cutter, model, jobs or 1, tell, warned)
        except (KeyboardInterrupt, Stopped) as failure:
            kept = StoredSweep(into, axes, (model, arguments))
            if isinstance(failure, Stopped):
                there = f"{into.runs} of {runs} runs are in {into.path}, the same call goes on with the others"
                raise Stopped(f"{failure}; {there}", typing.cast(typing.Any, kept)) from None
            failure.result = kept  # type: ignore[attr-defined]
            raise
    warn_of_runs([(text, sorted(numbers)) for text, numbers in warned.items()])
    return StoredSweep(into, axes, (model, arguments))


def _note(warned: dict[str, set[int]], more: list[Warned]) -> None:
    for text, runs in more:
        known = warned.setdefault(text, set())
        if len(known) < _MOST_WARNED:
            known.update(runs)


def _fill(into: Folder, cutter: Cutter, model: typing.Any, jobs: int, tell: Tell | None, warned: typing.Any) -> None:
    """In this process, part by part."""
    for number in into.missing:
        before, noted = into.runs, list[Warned]()
        arguments, place = cutter.cut(number)

        def look(done: float, total: float, before: int = before) -> None:
            if tell is not None:
                tell(before + done, cutter.runs)

        columns, runs, _ = model._core.sweep(*arguments, jobs, place, look, noted)
        _note(warned, noted)
        into.add(number, cutter.first(number) + 1, columns, tally_of(columns, runs))
    if tell is not None:
        tell(into.runs, cutter.runs)


def _fill_by(
    executor: typing.Any,
    into: Folder,
    cutter: Cutter,
    model: typing.Any,
    jobs: int,
    tell: Tell | None,
    warned: dict[str, set[int]],
) -> None:
    """By the workers of an executor: parts are written here, as they come."""
    missing = into.missing
    if not missing:
        return
    with stop_file() as stop, contextlib.closing(Workers(executor)) as workers:
        tasks = Tasks(workers, rows_of, Shares(cutter, lambda cut, place: (model, cut, jobs, place, stop), missing))

        def keep(i: int, rows: Rows) -> bool:
            columns, tally, noted, complete = rows
            if complete:
                _note(warned, noted)
                into.add(missing[i], cutter.first(missing[i]) + 1, columns, tally)
            return complete

        try:
            for i, rows in tasks:
                if not keep(i, rows):
                    raise KeyboardInterrupt
                if tell is not None:
                    tell(into.runs, cutter.runs)
        except BaseException:
            open(stop, "w").close()
            for i, rows in tasks.stop():
                keep(i, rows)
            raise


"""A sweep by an executor: shares for its workers, put together in their order."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
import typing

import numpy as np

from .. import _data
from .._result import Stopped
from .._sweep import Found, Results, RunWithoutRow, SweepArguments, Warned, warn_of_runs
from ._tasks import Task, Tasks, Workers

#: What a worker found, its warnings, and whether it came to the end.
Share = tuple[Found, list[Warned], bool]
Tell = typing.Callable[[float, float], None]
#: Number and number of all, from 1, and how many runs stand before those of the arguments.
Place = tuple[int, int, int]

#: Shares of a worker, so that none waits long for the last one; of a cluster whose workers are still to come; and the
#: most runs of a share, which is what a kill costs.
_FOR_EACH, _LEAST = 4, 16
MOST_RUNS = 1000
#: Lists of values that are longer as text are cut: a share is sent its own values only.
_LONG = 10_000
_SAMPLES = 4


class _Told(Exception):
    """That others have stopped."""


class Cutter:
    """Cuts a sweep into shares: consecutive runs, as equal in number as can be."""

    def __init__(self, arguments: SweepArguments, runs: int, number: int) -> None:
        self.arguments, self.runs, self.number = arguments, runs, max(1, min(number, runs))
        self._values = None if arguments[_SAMPLES] else _long_lists(arguments)

    def first(self, share: int) -> int:
        """How many runs stand before those of a share, from 1."""
        return (share - 1) * self.runs // self.number

    def size(self, share: int) -> int:
        return self.first(share + 1) - self.first(share)

    def name(self, share: int) -> str:
        first, last = self.first(share) + 1, self.first(share + 1)
        return f"run {first}" if first == last else f"runs {first} to {last}"

    def cut(self, share: int) -> tuple[SweepArguments, Place]:
        """What computes a share."""
        if self._values is None:
            return self.arguments, (share, self.number, 0)
        begin, end = self.first(share), self.first(share + 1)
        over = [f"{name}={','.join(values[begin:end])}" for name, values in self._values]
        settings, options, _, *rest = self.arguments
        return typing.cast(SweepArguments, (settings, options, over, *rest)), (1, 1, begin)


def _long_lists(arguments: SweepArguments) -> list[tuple[str, list[str]]] | None:
    """Names with their values, where these go one by one, are numbers and many."""
    _, _, over, paired, *_ = arguments
    if not (paired or len(over) == 1) or max(map(len, over), default=0) < _LONG:
        return None
    lists = [(name, text.split(",")) for name, _, text in (entry.partition("=") for entry in over)]
    try:
        for _, values in lists:
            np.array(values, dtype=float)
    except ValueError:
        return None  # words, or FROM:TO:NUMBER, which are short or told apart by all of their values
    return lists


@contextlib.contextmanager
def stop_file() -> typing.Iterator[str]:
    """The name of a file that is to appear when workers of this machine should end early."""
    folder = tempfile.mkdtemp(prefix="saltus-")
    try:
        yield os.path.join(folder, "stop")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def run_share(
    model: typing.Any, arguments: SweepArguments, jobs: int, share: Place, stop: str
) -> tuple[typing.Any, list[Warned], bool]:
    """What the library finds of one share, in whatever process; it ends early where the file `stop` appears."""
    warned: list[Warned] = []

    def look(done: float, total: float) -> None:
        if os.path.exists(stop):
            raise _Told

    try:
        look(0, 0)
        return model._core.sweep(*arguments, jobs, share, look, warned), warned, True
    except (KeyboardInterrupt, _Told) as stopped:
        return getattr(stopped, "result", ({}, [], [])), warned, False


def share_of(model: typing.Any, arguments: SweepArguments, jobs: int, share: Place, stop: str) -> Share:
    """The same with results, which are made here: what they are made of stays."""
    found, warned, complete = run_share(model, arguments, jobs, share, stop)
    return (found[0], list(Results(found, model, arguments, all_runs=False)), found[2]), warned, complete


def sweep_by(executor: typing.Any, model: typing.Any, arguments: SweepArguments, jobs: int, tell: Tell | None) -> Found:
    """All shares, a few for each worker. `result` of an interruption, and of :class:`Stopped` where workers ended, has
    the runs that were found."""
    workers = Workers(executor)
    _, runs = model._core.study(*arguments)
    cutter = Cutter(arguments, runs, max(_FOR_EACH * workers.number, -(-runs // MOST_RUNS), _LEAST))
    shares: dict[int, Share] = {}
    with stop_file() as stop, contextlib.closing(workers):
        tasks = Tasks(
            workers,
            share_of,
            Shares(cutter, lambda cut, place: (model, cut, jobs, place, stop)),
        )
        try:
            done = 0
            for i, share in tasks:
                shares[i] = share
                done += cutter.size(i + 1)
                if tell is not None:
                    tell(done, runs)
                if not share[2]:
                    raise KeyboardInterrupt
        except BaseException as failure:
            open(stop, "w").close()
            shares.update(tasks.stop())
            if isinstance(failure, (KeyboardInterrupt, Stopped)):
                failure.result = kept = _joined(shares)  # type: ignore[union-attr]
            if isinstance(failure, Stopped):
                raise Stopped(f"{failure}; {_kept(len(kept[1]), runs)}", failure.result) from None
            raise
    warn_of_runs([warning for _, warned, _ in shares.values() for warning in warned])
    found = _joined(shares)
    for i, result in enumerate(found[1]):
        if result._origin is None:
            result._origin = RunWithoutRow(model, arguments, i, len(found[1]))
    return found


def _kept(number: int, runs: int) -> str:
    return f"{number} of {runs} runs are in the attribute result of this error"


class Shares(typing.Sequence[Task]):
    """The tasks of a sweep, made when they are sent: values of a million runs are in memory once."""

    def __init__(
        self,
        cutter: Cutter,
        of: typing.Callable[[SweepArguments, Place], tuple[typing.Any, ...]],
        numbers: typing.Sequence[int] | None = None,
    ) -> None:
        """`numbers` are those that are wanted, from 1."""
        self._cutter, self._of = cutter, of
        self._numbers = range(1, cutter.number + 1) if numbers is None else numbers

    def __len__(self) -> int:
        return len(self._numbers)

    def __getitem__(self, i: typing.Any) -> typing.Any:
        number = self._numbers[i]
        return Task(self._of(*self._cutter.cut(number)), self._cutter.name(number))


def _joined(shares: dict[int, Share]) -> Found:
    parts = [found for _, (found, _, _) in sorted(shares.items()) if found[1]]
    if not parts:
        return {"run": [], "unique": []}, [], []
    joined = _data.put_together([part[0] for part in parts], len(parts[0][2]))
    return joined, [result for part in parts for result in part[1]], parts[0][2]

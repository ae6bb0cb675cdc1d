"""The starts of an optimisation by an executor: each by a worker, the best is the answer."""

from __future__ import annotations

import contextlib
import os
import typing

from .. import _core
from .._errors import ModelError
from .._expression import refuse
from .._result import Result, Stopped, load
from .._settings import Option
from ._tasks import Task, Tasks, Workers

Tell = typing.Callable[[float, float], None]
#: What a start came to, None where a function is not finite there, and what was warned of.
Optimum = tuple[typing.Optional[Result], list[str]]


def optimum_of(model: typing.Any, settings: list[str], options: list[Option], start: typing.Any, seed: int) -> Optimum:
    """What the start of one seed comes to, in whatever process."""
    alone = ("optimize.mpcc.seed", str(seed), f"seed={seed}")
    try:
        run, warned = model._optimum(settings, [*options, alone], start, None)
    except ModelError:
        if seed == 0:
            raise
        return None, []  # one process leaves such a start out, too
    return Result(run), warned


def optimize_by(
    executor: typing.Any,
    model: typing.Any,
    settings: list[str],
    options: list[Option],
    start: str | os.PathLike[str] | Result | None,
    tell: Tell | None,
) -> tuple[_core.Run, list[str]]:
    """The best of all starts, as one process gives it: also where they come in another order. `result` of an
    interruption, and of :class:`Stopped` where workers ended, is the best of those that are done."""
    count = model._core.starts(settings, options)
    if count < 2:
        raise refuse(f"executor={type(executor).__name__}: there is one start, and it is for one process", "e.g. starts=8")
    if isinstance(start, (str, os.PathLike)):
        start = load(start)  # workers may be on machines without the file
    found: dict[int, Optimum] = {}
    with contextlib.closing(Workers(executor)) as workers:
        each = [Task((model, settings, options, start, seed), f"the start of seed {seed}") for seed in range(count)]
        tasks = Tasks(workers, optimum_of, each)
        try:
            for seed, optimum in tasks:
                found[seed] = optimum
                if tell is not None:
                    tell(len(found), count)
        except (KeyboardInterrupt, Stopped) as failure:
            found.update(tasks.stop())
            best = _best(found)
            if isinstance(failure, Stopped):
                there = f"the best of {len(found)} other starts is in the attribute result of this error" if best else ""
                raise Stopped("; ".join(filter(None, (str(failure), there))), Result(best) if best else None) from None
            failure.result = Result(best) if best else None  # type: ignore[attr-defined]
            raise
    best = _best(found)
    assert best is not None  # the first one is there, or has raised
    # Once, as one process warns of the problem, not of its starts.
    return best, list(dict.fromkeys(warning for _, (_, warned) in sorted(found.items()) for warning in warned))


def _best(found: dict[int, Optimum]) -> _core.Run | None:
    runs = [result._run for _, (result, _) in sorted(found.items()) if result is not None]
    return _core.best_of_starts(runs) if runs else None

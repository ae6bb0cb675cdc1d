"""A sweep by an executor: shares for its workers, put together in their order."""

from __future__ import annotations

import os
import shutil
import tempfile
import typing

import numpy as np

from ._sweep import Found, Results, RunWithoutRow, SweepArguments, Warned, warn_of_runs

#: What a worker found, its warnings, and whether it came to the end.
Share = tuple[Found, list[Warned], bool]
Tell = typing.Callable[[float, float], None]


class _Told(Exception):
    """That others have stopped."""


def share_of(model: typing.Any, arguments: SweepArguments, jobs: int, share: tuple[int, int], stop: str) -> Share:
    """One share, in whatever process; it ends early where the file `stop` appears. Results are made here: what they are
    made of stays."""
    warned: list[Warned] = []

    def look(done: float, total: float) -> None:
        if os.path.exists(stop):
            raise _Told

    try:
        look(0, 0)
        found, complete = model._core.sweep(*arguments, jobs, share, look, warned), True
    except (KeyboardInterrupt, _Told) as stopped:
        found, complete = getattr(stopped, "result", ({}, [], [])), False
    return (found[0], list(Results(found, model, arguments, all_runs=False)), found[2]), warned, complete


def sweep_by(executor: typing.Any, model: typing.Any, arguments: SweepArguments, jobs: int, tell: Tell | None) -> Found:
    """All shares, a few for each worker. Of an interruption `result` has the runs that began."""
    if not callable(getattr(executor, "submit", None)):
        raise TypeError(
            f"executor={type(executor).__name__}: expected one of concurrent.futures, with a method submit, "
            "e.g. ProcessPoolExecutor()"
        )
    number = 4 * (getattr(executor, "_max_workers", None) or os.cpu_count() or 1)
    folder = tempfile.mkdtemp(prefix="saltus-")
    stop, futures, shares = os.path.join(folder, "stop"), [], []
    try:
        futures += [executor.submit(share_of, model, arguments, jobs, (i + 1, number), stop) for i in range(number)]
        for i, future in enumerate(futures, 1):
            shares.append(future.result())
            if tell is not None:
                tell(i, number)
        if not all(complete for _, _, complete in shares):
            raise KeyboardInterrupt
    except BaseException as failure:
        shares = _stopped(futures, stop)
        if isinstance(failure, KeyboardInterrupt):
            failure.result = _joined(shares)  # type: ignore[attr-defined]
        raise
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    warn_of_runs([warning for _, warned, _ in shares for warning in warned])
    found = _joined(shares)
    for i, result in enumerate(found[1]):
        if result._origin is None:
            result._origin = RunWithoutRow(model, arguments, i, len(found[1]))
    return found


def _stopped(futures: list[typing.Any], stop: str) -> list[Share]:
    """What there is when no worker works any more."""
    open(stop, "w").close()
    shares = []
    for future in [future for future in futures if not future.cancel()]:
        try:
            shares.append(future.result())
        except Exception:
            continue
    return shares


def _joined(shares: list[Share]) -> Found:
    parts = [share for share, _, _ in shares if share[1]]
    if not parts:
        return {"run": [], "unique": []}, [], []
    columns = max((part[0] for part in parts), key=len)
    joined = {name: np.concatenate([np.asarray(part[0][name]) for part in parts]) for name in columns}
    return joined, [result for part in parts for result in part[1]], parts[0][2]

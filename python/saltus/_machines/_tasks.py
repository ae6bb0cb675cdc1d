"""Tasks by the workers of an executor: a worker that ends costs the task that it had, which another one does again."""

from __future__ import annotations

import collections
import concurrent.futures
import dataclasses
import importlib
import os
import pickle
import pkgutil
import queue
import time
import typing

from .. import _core
from .._result import Stopped

#: How often a task is begun whose worker ends.
MOST_TRIES = 3
#: From this try on it has the workers for itself: then it is known who ends them.
_ALONE = 2
#: Pools that may end one after the other without a task that is done: more would end, too.
_MOST_POOLS = 8
#: How long the number of workers of a cluster is believed: to ask takes milliseconds.
_SECONDS_OF_LOOK = 2.0
#: Errors of dask and Ray, which have begun such a task several times themselves.
_TRIED = ("KilledWorker", "WorkerCrashedError", "OutOfMemoryError")
#: What each worker has in reserve, so that none waits for the answer to be read.
_FOR_EACH = 2


@dataclasses.dataclass(frozen=True)
class Task:
    """What a function is called with, and how a message calls it."""

    arguments: tuple[typing.Any, ...]
    name: str


class Workers:
    """An executor, and another one like it where its workers have ended."""

    def __init__(self, executor: typing.Any) -> None:
        """`executor` is one of concurrent.futures, one with its interface, or a function that makes one."""
        self._given: typing.Any = None
        self._make: typing.Callable[[], typing.Any] | None = None
        if callable(getattr(executor, "submit", None)) and not isinstance(executor, type):
            self._given = self._now = executor
            self._make = _maker_like(executor)
        elif callable(executor):  # also a class
            self._make, self._now = executor, executor()
        else:
            raise TypeError(
                f"executor={type(executor).__name__}: expected one of concurrent.futures, with a method submit, "
                "e.g. ProcessPoolExecutor(), or a function that makes one"
            )
        self.generation = 0
        self._threads, self._next_look = 1, 0.0

    @property
    def kind(self) -> str:
        return type(self._now).__name__

    @property
    def number(self) -> int:
        """How many there are, as far as the executor says it."""
        client: typing.Any = getattr(self._now, "_client", None)  # of dask, whose workers come and go
        if callable(getattr(client, "nthreads", None)):
            if time.monotonic() >= self._next_look:
                self._threads = max(1, sum(client.nthreads().values()))
                self._next_look = time.monotonic() + _SECONDS_OF_LOOK
            return self._threads
        for name in ("_max_workers", "num_workers"):
            found = getattr(self._now, name, None)
            if isinstance(found, int) and found > 0:
                return found
        return os.cpu_count() or 1

    def submit(self, function: typing.Any, *arguments: typing.Any) -> typing.Any:
        """A future; of a pool whose workers have ended one of the pool that takes its place."""
        try:
            return self._now.submit(function, *arguments)
        except concurrent.futures.BrokenExecutor as broken:
            self.renew(broken)
        except Exception as error:
            raise Stopped(f"{self.kind} takes no more work: {_sentence(error)}") from None
        return self._now.submit(function, *arguments)

    def renew(self, reason: BaseException) -> None:
        """Puts another pool in the place of this one."""
        if self._make is None:
            raise Stopped(
                f"the workers of {self.kind} have ended ({_sentence(reason)}), and how it was made is not known; "
                "executor= may be a function that makes one, then its work goes on in a new one"
            ) from None
        self._end()
        self._now = self._make()
        self.generation += 1

    def close(self) -> None:
        """Ends what was made here; the executor that was given is its owner's."""
        if self._now is not self._given:
            self._end()

    def _end(self) -> None:
        if self._now is not self._given and callable(getattr(self._now, "shutdown", None)):
            self._now.shutdown()

    def check(self) -> None:
        """Whether they have this version of the package; said before anything is sent that needs it."""
        for is_last in (False, True):
            try:
                # A function of Python's own: a worker without the package says so, instead of ending.
                asked = [self.submit(pkgutil.resolve_name, "saltus:__version__") for _ in range(self.number)]
                version = asked[0].result()
                break
            except ImportError as missing:
                raise Stopped(
                    f"the workers of {self.kind} have no saltus ({_sentence(missing)}): install version {_core.version} "
                    "where they run"
                ) from None
            except concurrent.futures.BrokenExecutor as broken:
                if is_last:
                    raise Stopped(
                        f"the workers of {self.kind} end before they begin ({_sentence(broken)}); what begins processes "
                        'stands under `if __name__ == "__main__":`'
                    ) from None
                self.renew(broken)
        if version != _core.version:
            raise Stopped(
                f"the workers of {self.kind} have version {version} of saltus, this process {_core.version}: install the "
                "same one, digits may differ between them"
            )


class Tasks:
    """All tasks, each done once: iterate over (number, what the function returned), as they come.

    What a task raises is raised here, and ends all. A task whose worker ends is begun again, in a new pool where the
    pool is broken, `MOST_TRIES` times in all. What is still not done then is raised as :class:`Stopped` at the end, when
    all others are done.
    """

    def __init__(self, workers: Workers, function: typing.Any, tasks: typing.Sequence[Task]) -> None:
        self._workers, self._function, self._tasks = workers, function, tasks
        self._waiting = collections.deque(range(len(tasks)))
        self._tries = [0] * len(tasks)
        self._flying: dict[typing.Any, tuple[int, int]] = {}  # number and generation, by future
        self._arrived: queue.SimpleQueue[typing.Any] = queue.SimpleQueue()
        self._lost: dict[int, str] = {}
        self._pools = 0  # that ended since a task was done

    def __iter__(self) -> typing.Iterator[tuple[int, typing.Any]]:
        self._workers.check()
        while self._send() or self._flying:
            future = self._arrived.get()
            number, generation = self._flying.pop(future)
            try:
                good, value = future.result()
            except KeyboardInterrupt:
                raise
            except BaseException as error:  # also asyncio's CancelledError
                self._worker_ended(number, generation, error)
                continue
            if not good:
                raise value
            self._pools = 0
            yield number, value
        if self._lost:
            raise Stopped(self._told())

    def stop(self) -> list[tuple[int, typing.Any]]:
        """Sends nothing more, and returns what is done when no worker works any more."""
        self._waiting.clear()
        done = []
        for future, (number, _) in self._flying.items():
            if future.cancel():
                continue
            try:
                good, value = future.result()
            except KeyboardInterrupt:
                break  # a second one: workers of other machines do not hear the first
            except BaseException:
                continue
            if good:
                done.append((number, value))
        self._flying.clear()
        return done

    def _send(self) -> bool:
        """Gives every worker what it can have; whether anything is left to be waited for."""
        most = _FOR_EACH * self._workers.number
        while self._waiting and len(self._flying) < most:
            number = self._waiting[0]
            alone = self._tries[number] >= _ALONE
            if alone and self._flying:
                break
            future = self._workers.submit(attempt, self._function, *self._tasks[number].arguments)
            self._waiting.popleft()
            self._flying[future] = number, self._workers.generation
            future.add_done_callback(self._arrived.put)
            if alone:
                break
        return bool(self._flying)

    def _worker_ended(self, number: int, generation: int, error: BaseException) -> None:
        self._tries[number] += 1
        if type(error).__name__ in _TRIED:
            self._lost[number] = f"its workers ended again and again ({_sentence(error)})"
        elif self._tries[number] < MOST_TRIES:
            self._waiting.appendleft(number)
        else:
            self._lost[number] = f"the worker ended {MOST_TRIES} times ({_sentence(error)})"
        is_broken = isinstance(error, concurrent.futures.BrokenExecutor)
        if is_broken and generation == self._workers.generation:
            self._pools += 1
            if self._pools > _MOST_POOLS:
                raise Stopped(f"the workers of {self._workers.kind} end, whatever they have to do ({_sentence(error)})")
            self._workers.renew(error)

    def _told(self) -> str:
        number, reason = next(iter(sorted(self._lost.items())))
        more = f" (and {len(self._lost) - 1} others)" if len(self._lost) > 1 else ""
        return f"{self._tasks[number].name}{more}: {reason}"


def attempt(function: typing.Any, *arguments: typing.Any) -> tuple[bool, typing.Any]:
    """What a worker calls: mistakes come back as values, so that others are known to be the worker's end."""
    try:
        return True, function(*arguments)
    except MemoryError:
        raise  # another worker may have more
    except Exception as error:
        try:
            pickle.loads(pickle.dumps(error))
        except Exception:
            return False, RuntimeError(f"{type(error).__name__}: {error}")
        return False, error


def _sentence(error: BaseException) -> str:
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= 200 else text[:197] + "..."


def _maker_like(executor: typing.Any) -> typing.Callable[[], typing.Any] | None:
    """What makes another pool of processes like this one; None of executors that mend themselves, or are not known."""
    kind: typing.Any = type(executor)
    if issubclass(kind, concurrent.futures.ProcessPoolExecutor):
        return lambda: kind(
            executor._max_workers,
            mp_context=executor._mp_context,
            initializer=executor._initializer,
            initargs=executor._initargs,
        )
    if "loky" not in kind.__module__.split("."):
        return None
    loky = importlib.import_module(kind.__module__.partition("loky")[0] + "loky")
    if "Reusable" in kind.__name__:
        return lambda: loky.get_reusable_executor(executor._max_workers)
    return lambda: kind(
        executor._max_workers,
        context=executor._context,
        timeout=executor._timeout,
        initializer=executor._initializer,
        initargs=executor._initargs,
    )

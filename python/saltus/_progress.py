"""How far a run is: a bar of tqdm if it is there (a widget in notebooks), else a line on standard error."""

from __future__ import annotations

import contextlib
import sys
import threading
import time
import typing

Say = typing.Callable[[str], None]

#: Seconds between two words of what is still prepared.
_EVERY = 0.5


class Tell:
    """What a run calls on its way; `prepare` before its first step, with `done` of `all` parts (0: nobody knows)."""

    def __call__(self, t: float, begin: float, end: float, steps: int, events: int) -> None:
        raise NotImplementedError

    def prepare(self, phase: str, done: int, all: int) -> None:
        raise NotImplementedError


@contextlib.contextmanager
def progress_line(name: str, wanted: bool) -> typing.Iterator[Tell | None]:
    """What a run calls on its way, or None if nothing is wanted."""
    if not wanted:
        yield None
        return
    tqdm = _tqdm()
    if tqdm is None:
        yield from _plain(name)
        return
    with tqdm(total=100.0, desc=name, bar_format="{desc}: {percentage:3.0f}%|{bar}| {postfix}") as bar:

        class Bar(Tell):
            def __call__(self, t: float, begin: float, end: float, steps: int, events: int) -> None:
                bar.set_postfix_str(f"t = {t:.6g}, {steps} steps, {events} events", refresh=False)
                bar.update(max(0.0, 100.0 * (t - begin) / (end - begin) - bar.n))

            def prepare(self, phase: str, done: int, all: int) -> None:
                bar.set_postfix_str(_prepared(phase, done, all))

        yield Bar()
        bar.set_postfix_str("done", refresh=False)
        bar.update(max(0.0, 100.0 - bar.n))


@contextlib.contextmanager
def lines_of_problems(name: str, wanted: bool) -> typing.Iterator[Say | None]:
    """A function of a line for every problem that was solved, or None if nothing is wanted."""
    if not wanted:
        yield None
        return
    tqdm = _tqdm()
    if tqdm is None:
        with _Preparing(lambda text: print(f"{name}: {text}", file=sys.stderr, flush=True), 5.0) as preparing:

            def say(line: str) -> None:
                preparing.stop()
                print(line, file=sys.stderr, flush=True)

            yield say
        return
    with tqdm(desc=name, unit=" problems", bar_format="{desc}: {n_fmt} problems, {elapsed} {postfix}") as bar:
        with _Preparing(bar.set_postfix_str) as preparing:

            def note(line: str) -> None:
                preparing.stop()
                bar.set_postfix_str(" ".join(line.split()), refresh=False)
                bar.update(1)

            yield note


@contextlib.contextmanager
def progress_of_runs(name: str, wanted: bool, what: str) -> typing.Iterator[typing.Callable[[float, float], None] | None]:
    """A function of (done, all), counted in `what`; or None if nothing is wanted."""
    if not wanted:
        yield None
        return
    tqdm = _tqdm()
    if tqdm is None:
        yield from _plain_of_runs(name, what)
        return
    with tqdm(desc=name, unit=f" {what}") as bar:

        def tell(done: float, total: float) -> None:
            if bar.total is None and done < total:
                bar.initial = bar.n = int(done)  # what was there before is not counted in the rate
            bar.total = int(total)
            bar.update(int(done) - bar.n)

        yield tell


def _tqdm() -> typing.Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return tqdm


class _Preparing:
    """Says every half second that a model is still prepared, as soon as that takes long; in a thread of its own."""

    def __init__(self, say: Say, every: float = _EVERY) -> None:
        self._say, self._every = say, every
        self._over = threading.Event()
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> _Preparing:
        self._thread.start()
        return self

    def _run(self) -> None:
        begin = time.monotonic()
        while not self._over.wait(self._every):
            with self._lock:
                if not self._over.is_set():
                    self._say(f"preparing, {time.monotonic() - begin:.0f} s")

    def stop(self) -> None:
        """Nothing is said after that."""
        if not self._over.is_set():
            with self._lock:
                self._over.set()

    def __exit__(self, *_: object) -> None:
        self.stop()
        self._thread.join()


def _plain_of_runs(name: str, what: str) -> typing.Iterator[typing.Callable[[float, float], None]]:
    def tell(done: float, total: float) -> None:
        print(f"\r{name}: {done:.0f} of {total:.0f} {what}", end="", file=sys.stderr, flush=True)

    try:
        yield tell
    finally:
        print(file=sys.stderr)


def _prepared(phase: str, done: int, all: int) -> str:
    return f"{phase}: {done} of {all}" if all else phase


class _Line(Tell):
    def __init__(self, name: str) -> None:
        self.name, self.width = name, 0

    def show(self, text: str) -> None:
        self.width = max(self.width, len(text))
        print("\r" + text.ljust(self.width), end="", file=sys.stderr, flush=True)

    def __call__(self, t: float, begin: float, end: float, steps: int, events: int) -> None:
        share = 100.0 * (t - begin) / (end - begin)
        self.show(f"{self.name}: t = {t:.6g}   {share:.0f} %   {steps} steps   {events} events")

    def prepare(self, phase: str, done: int, all: int) -> None:
        self.show(f"{self.name}: {_prepared(phase, done, all)}")


def _plain(name: str) -> typing.Iterator[Tell]:
    line = _Line(name)
    try:
        yield line
    finally:
        if line.width:
            print("\r" + " " * line.width + "\r", end="", file=sys.stderr, flush=True)

"""How far a run is: a bar of tqdm if it is there, else a line on standard error."""

from __future__ import annotations

import contextlib
import sys
import typing


class Tell:
    """What a run calls on its way; `prepare` before its first step, with `done` of `all` parts (0: nobody knows)."""

    def __call__(self, t: float, begin: float, end: float, steps: int, events: int) -> None:
        raise NotImplementedError

    def prepare(self, phase: str, done: int, all: int) -> None:
        raise NotImplementedError



@contextlib.contextmanager
def progress_line(name: str, wanted: bool) -> typing.Iterator[Tell | None]:
    """A function of (t, from, until, steps, events), or None if nothing is wanted."""
    if not wanted:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
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
        bar.update(max(0.0, 100.0 - bar.n))


@contextlib.contextmanager
def progress_of_runs(name: str, wanted: bool, what: str) -> typing.Iterator[typing.Callable[[float, float], None] | None]:
    """A function of (done, all), counted in `what`; or None if nothing is wanted."""
    if not wanted:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield from _plain_of_runs(name, what)
        return
    with tqdm(desc=name, unit=f" {what}") as bar:

        def tell(done: float, total: float) -> None:
            if bar.total is None and done < total:
                bar.initial = bar.n = int(done)  # what was there before is not counted in the rate
            bar.total = int(total)
            bar.update(int(done) - bar.n)

        yield tell


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
    yield line
    if line.width:
        print("\r" + " " * line.width + "\r", end="", file=sys.stderr, flush=True)

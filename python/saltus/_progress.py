"""How far a run is: a bar of tqdm if it is there, else a line on standard error."""

from __future__ import annotations

import contextlib
import sys
import typing

Tell = typing.Callable[[float, float, float, int, int], None]


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

        def tell(t: float, begin: float, end: float, steps: int, events: int) -> None:
            bar.set_postfix_str(f"t = {t:.6g}, {steps} steps, {events} events", refresh=False)
            bar.update(max(0.0, 100.0 * (t - begin) / (end - begin) - bar.n))

        yield tell
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


def _plain(name: str) -> typing.Iterator[Tell]:
    width = 0

    def tell(t: float, begin: float, end: float, steps: int, events: int) -> None:
        nonlocal width
        text = f"{name}: t = {t:.6g}   {100.0 * (t - begin) / (end - begin):.0f} %   {steps} steps   {events} events"
        width = max(width, len(text))
        print("\r" + text.ljust(width), end="", file=sys.stderr, flush=True)

    yield tell
    if width:
        print("\r" + " " * width + "\r", end="", file=sys.stderr, flush=True)

"""What pictures need of a result: curves that break at jumps, spans of sliding, marks of events."""

from __future__ import annotations

import typing

import numpy as np

if typing.TYPE_CHECKING:
    from ._result import Result

Array = np.ndarray[typing.Any, np.dtype[typing.Any]]


def as_drawn(r: Result) -> Result:
    """The result with two rows at every event, which it need not have: what pages and figures show."""
    run = r._run.drawn()
    return r if run is None else type(r)(run)


def broken_at_jumps(r: Result, *columns: Array) -> list[Array]:
    """The columns with a NaN between the two rows of every jump of one of them, so that no line joins them."""
    places: set[int] = set()
    twice = np.flatnonzero(np.diff(r.t) == 0)
    for column in columns:
        finite = column[np.isfinite(column)]
        if len(twice) and len(finite):
            step = np.abs(np.diff(column.astype(float))[twice])
            places.update((twice[step > 1e-6 * np.ptp(finite)] + 1).tolist())
    if not places:
        return list(columns)
    return [np.insert(column.astype(float), sorted(places), np.nan) for column in columns]


def is_alone(values: Array) -> Array:
    """Of every value, whether it lies between two gaps, where no line is drawn through it."""
    missing = np.isnan(np.concatenate(([np.nan], values, [np.nan])))
    lone: Array = ~missing[1:-1] & missing[:-2] & missing[2:]
    return lone


def sliding_spans(r: Result) -> list[tuple[float, float]]:
    """Intervals of time in which the solution slides on at least one surface, joined where they touch."""
    if r.mode.shape[1] == 0 or len(r.t) < 2:
        return []
    slides = np.any(r.mode == 0, axis=1)
    # Between two rows the mode is that of both; at an event the rows differ and have no length between them.
    held = slides[:-1] & slides[1:] & (np.diff(r.t) > 0)
    spans: list[tuple[float, float]] = []
    for i in np.flatnonzero(held):
        begin, end = float(r.t[i]), float(r.t[i + 1])
        if spans and spans[-1][1] == begin:
            spans[-1] = (spans[-1][0], end)
        else:
            spans.append((begin, end))
    return spans


def slides(r: Result) -> Array:
    """Of every row, whether the solution slides there."""
    return np.any(r.mode == 0, axis=1) if r.mode.shape[1] else np.zeros(len(r.t), dtype=bool)


def thinned(t: Array, y: Array, most: int) -> tuple[Array, Array]:
    """At most about `most` points: of every stretch the smallest and the largest value, in their order."""
    if len(t) <= most:
        return t, y
    edges = np.linspace(0, len(t), most // 2 + 1).astype(int)
    chosen: list[int] = []
    for begin, end in zip(edges[:-1], edges[1:]):
        part = y[begin:end]
        if np.isnan(part).any():
            chosen.extend(range(begin, end))
            continue
        chosen.extend(sorted({begin + int(np.argmin(part)), begin + int(np.argmax(part))}))
    index = np.array(chosen)
    return t[index], y[index]

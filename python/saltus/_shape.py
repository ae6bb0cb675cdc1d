"""What pictures need of a result: curves that break at jumps, spans of sliding, marks of events."""

from __future__ import annotations

import typing

import numpy as np

from ._recorded import Recorded

Array = np.ndarray[typing.Any, np.dtype[typing.Any]]


def as_drawn(r: Recorded) -> Recorded:
    """The result with two rows at every event, which it need not have: what pages and figures show."""
    run = r._run.drawn()
    return r if run is None else Recorded(run)


def broken_at_jumps(r: Recorded, *columns: Array) -> list[Array]:
    """The columns with a NaN between the two rows of every jump of one of them, so that no line joins them."""
    places = sorted({int(row) + 1 for column in columns for row in _jumps(r.t, column)})
    if not places:
        return list(columns)
    return [np.insert(column.astype(float), places, np.nan) for column in columns]


def _jumps(t: Array, column: Array) -> Array:
    """Rows behind which the next one has the same time and another value."""
    finite = column[np.isfinite(column)]
    twice = np.flatnonzero(np.diff(t) == 0)
    if len(twice) == 0 or len(finite) == 0:
        return twice[:0]
    rows: Array = twice[np.abs(np.diff(column.astype(float))[twice]) > 1e-6 * np.ptp(finite)]
    return rows


def is_stepwise(t: Array, column: Array) -> bool:
    """Whether a column changes at events only, as discrete states do and the outputs of relays."""
    there = np.isfinite(column)
    changes = np.diff(column[there].astype(float)) != 0
    return bool(changes.any()) and not np.any(changes & (np.diff(t[there]) > 0))


def edges(t: Array, column: Array) -> tuple[Array, Array]:
    """Upright lines between the two sides of every jump, with a NaN behind each of them."""
    jumps = _jumps(t, column)
    y = np.column_stack([column[jumps], column[jumps + 1], np.full(len(jumps), np.nan)])
    return np.repeat(t[jumps], 3), y.ravel()


def is_alone(values: Array) -> Array:
    """Of every value, whether it lies between two gaps, where no line is drawn through it."""
    missing = np.isnan(np.concatenate(([np.nan], values, [np.nan])))
    lone: Array = ~missing[1:-1] & missing[:-2] & missing[2:]
    return lone


def sliding_spans(r: Recorded) -> list[tuple[float, float]]:
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


def slides(r: Recorded) -> Array:
    """Of every row, whether the solution slides there."""
    return np.any(r.mode == 0, axis=1) if r.mode.shape[1] else np.zeros(len(r.t), dtype=bool)


def thinned(t: Array, y: Array, most: int) -> tuple[Array, Array]:
    """At most about twice `most` points: of every stretch the smallest and the largest value, in their order, on both
    sides of a gap; a stretch with several gaps is a line from its smallest to its largest value."""
    if len(t) <= most:
        return t, y
    edges = np.linspace(0, len(t), most // 2 + 1).astype(int)
    chosen: list[int] = []
    for begin, end in zip(edges[:-1], edges[1:]):
        there = np.flatnonzero(~np.isnan(y[begin:end])) + begin
        pieces = np.split(there, np.flatnonzero(np.diff(there) > 1) + 1)
        if len(pieces) > 2:
            pieces = [there]
        for piece in pieces:
            if len(piece) == 0 or piece[0] > begin:
                chosen.append(begin if len(piece) == 0 else int(piece[0]) - 1)
            if len(piece):
                chosen.extend(sorted({int(piece[np.argmin(y[piece])]), int(piece[np.argmax(y[piece])])}))
        if len(there) and there[-1] + 1 < end:
            chosen.append(int(there[-1]) + 1)
    index = np.array(chosen)
    return t[index], y[index]


def corners(t: Array, y: Array) -> tuple[Array, Array]:
    """Of a column that is stepwise the ends of its steps."""
    changes = np.flatnonzero(np.diff(y) != 0)
    index = np.unique(np.concatenate([[0], changes, changes + 1, [len(t) - 1]]))
    return t[index], y[index]

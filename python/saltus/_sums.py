"""Products of matrices of numbers with lists of expressions: each sum is written once, not term by term."""

from __future__ import annotations

import typing

import numpy as np

from ._expression import (
    DEEPEST,
    FARTHEST,
    HIGHEST,
    LONG,
    PRODUCT,
    SIGN,
    SUM,
    Expression,
    _inside,
    _part_of,
    number,
    number_text,
    owner_of,
    refuse,
)

Numbers = np.ndarray[typing.Any, typing.Any]


def _with_room(entry: Expression) -> Expression:
    """Its name where no operation may be added to it."""
    full = entry.height + 1 >= HIGHEST or entry.depth + 1 >= DEEPEST or len(entry.text) + 40 >= LONG
    return _part_of(entry) if full else entry


class _Terms:
    """What stands beside the numbers, each made ready once for all rows."""

    def __init__(self, entries: typing.Iterable[typing.Any], numbers_first: bool) -> None:
        self.numbers_first = numbers_first
        self.entries = [_with_room(number(entry)) for entry in entries]
        level = SIGN if numbers_first else PRODUCT
        self.texts = [_inside(entry, level) for entry in self.entries]
        self.depths = [entry.depth + (entry.level < level) for entry in self.entries]
        self.owner = owner_of(*self.entries)

    def sum(self, weights: list[typing.Any]) -> Expression:
        """The text that ``w[0]*e[0] + w[1]*e[1] + …`` has, and where that is too large the same names of parts."""
        made: Expression | None = None
        written: list[str] = []
        length, height, reach, depth = -1, 0, 0, 0
        parts: dict[str, Expression] = {}

        def close() -> Expression:
            whole = Expression("+".join(written), SUM if len(written) > 1 else PRODUCT, owner=self.owner)
            whole.height, whole.reach, whole.depth, whole.parts = height, reach, depth, parts
            return whole

        for weight, entry, text, its_depth in zip(weights, self.entries, self.texts, self.depths):
            if height >= HIGHEST or depth >= DEEPEST or length >= LONG:
                made = _part_of(close())
                written, length, height, reach, depth, parts = [made.text], len(made.text), made.height, made.reach, made.depth, dict(made.parts)
            of_number = number_text(weight)
            term = f"{of_number}*{text}" if self.numbers_first else f"{text}*{of_number}"
            height = max(height + bool(written), 1 + entry.height + bool(written))
            reach = max(reach + bool(written), 1 + entry.reach + bool(written))
            depth = max(depth, its_depth)
            if reach > FARTHEST:
                raise refuse(
                    f"a sum of more than {FARTHEST} terms: {term[:40]}…",
                    "multiply by parts of the matrix, and add what comes out: A[:, :n] @ X[:n] + A[:, n:] @ X[n:]",
                )
            if entry.parts:
                parts = {**parts, **entry.parts}
            written.append(term)
            length += 1 + len(term)
        return close()


def _is_matrix(value: typing.Any) -> bool:
    return value.dtype.kind in "iuf" and value.ndim in (1, 2) and value.size > 0 and bool(np.isfinite(value).all())


def product(a: typing.Any, b: typing.Any) -> typing.Any:
    """``a @ b`` of numbers and one list of expressions; NotImplemented for everything else."""
    for numbers, entries, first in ((a, b, True), (b, a, False)):
        if not (isinstance(numbers, np.ndarray) and isinstance(entries, np.ndarray)):
            continue
        if entries.dtype != object or entries.ndim != 1 or not _is_matrix(numbers):
            continue
        rows = numbers if first or numbers.ndim == 1 else numbers.T
        if rows.shape[-1] != entries.size:
            return NotImplemented
        terms = _Terms(entries, first)
        if rows.ndim == 1:
            return terms.sum(rows.tolist())
        made = np.empty(rows.shape[0], dtype=object)
        for i, row in enumerate(rows.tolist()):
            made[i] = terms.sum(row)
        return made
    return NotImplemented

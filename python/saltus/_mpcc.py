"""Problems with complementarities that other programs wrote."""

from __future__ import annotations

import json
import os
import pathlib
import typing

import numpy as np

from . import _core
from ._card import table_card
from ._errors import warn
from ._expression import refuse
from ._progress import lines_of_problems
from ._settings import option_of
from ._signature import with_options

if typing.TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import MpccOptions

Array = np.ndarray[typing.Any, np.dtype[typing.Any]]

#: min (x - 2)^2 + (y - 1)^2 with 0 <= x, 0 <= y, one of them 0, as AMPL writes it: of the examples below.
CORNER = (
    "g3 1 1 0\n 2 1 1 0 0\n 0 1 1 0\n 0 0\n 0 2 0\n 0 0 0 1\n 0 0 0 0 0\n 1 0\n 0 0\n 0 0 0 0 0\nC0\nn0\nO0 0\no0\no5\no0\nv0\n"
    "n-2\nn2\no5\no0\nv1\nn-1\nn2\nx2\n0 1\n1 1\nr\n5 1 1\nb\n2 0\n2 0\nk1\n0\nJ0 1\n1 1\n"
)


def corner() -> str:
    """A file that has it."""
    import tempfile

    file = pathlib.Path(tempfile.mkdtemp()) / "corner.nl"
    file.write_text(CORNER)
    return str(file)


class Mpcc:
    """The point that was found for a foreign problem: ``status``, ``objective``, ``x``, ``names``, ``certificate``,
    ``multipliers``, ``homotopy``, ``statistics``; ``print`` shows it as ``saltus mpcc`` does.

    ``status`` is "completed" for a point that is feasible, complementary, stationary and has no first-order descent
    direction (``done``), else says what is missing, with a ``message``.

    >>> p = saltus.mpcc(saltus._mpcc.corner())
    >>> p.status, p.x.round(6).tolist(), round(p.objective, 6)
    ('completed', [2.0, 0.0], 1.0)
    """

    def __init__(self, found: tuple[str, str, bool]) -> None:
        text, self._table, self.done = found
        stored = json.loads(text)
        self._stored: dict[str, typing.Any] = stored
        self.status: str = stored["status"]["termination"]
        self.message: str = stored["status"]["message"]
        self.objective: float = stored["objective"]
        self.x: Array = np.array(stored["x"], dtype=float)
        self.names: list[str] = stored["names"]
        self.certificate: dict[str, typing.Any] = stored["certificate"]
        self.multipliers: dict[str, typing.Any] = stored["multipliers"]
        self.homotopy: list[dict[str, typing.Any]] = stored["homotopy"]
        self.statistics: dict[str, typing.Any] = stored["statistics"]

    def __getitem__(self, name: str) -> float:
        """A variable by its name, where the file has names.

        >>> try:
        ...     saltus.mpcc(saltus._mpcc.corner())["x"]
        ... except KeyError as error:
        ...     print(error.args[0])
        the problem has no variable 'x': its file has no names
        """
        if name not in self.names:
            raise KeyError(f"the problem has no variable {name!r}: {', '.join(self.names[:20]) or 'its file has no names'}")
        return float(self.x[self.names.index(name)])

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.names)

    def to_dict(self) -> dict[str, typing.Any]:
        """Everything, as ``saltus mpcc --out`` writes it.

        >>> saltus.mpcc(saltus._mpcc.corner()).to_dict()["format"]
        'saltus-mpcc/1'
        """
        return self._stored

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the file of ``saltus mpcc --out`` (.json).

        >>> import tempfile, pathlib
        >>> file = pathlib.Path(tempfile.mkdtemp()) / "p.json"
        >>> saltus.mpcc(saltus._mpcc.corner()).save(file)
        >>> file.exists()
        True
        """
        name = os.fspath(path)
        if not name.endswith(".json"):
            raise refuse(f"{name}: the name must end in .json", 'p.save("p.json")')
        _core.write_file(name, json.dumps(self._stored, indent=1) + "\n")

    def __str__(self) -> str:
        return self._table

    def __repr__(self) -> str:
        return f"<saltus.Mpcc of {len(self.x)} variables: {self.status}, objective {self.objective:.8g}>"

    def _repr_html_(self) -> str:
        return table_card("", self._table)


@with_options("mpcc")
def mpcc(
    path: str | os.PathLike[str],
    *,
    start: Mpcc | typing.Sequence[float] | Array | None = None,
    progress: bool = False,
    **options: Unpack[MpccOptions],
) -> Mpcc:
    """Solves a problem with complementarities that another program wrote, as ``saltus mpcc`` does: AMPL .nl text, or
    JSON of NOSBENCH or mpecopt.

    `start` are values of its variables, in the order of the file, or an earlier result. Ctrl-C raises
    KeyboardInterrupt, whose ``result`` is what was found until then. Bad input raises :class:`ModelError`.

    >>> p = saltus.mpcc(saltus._mpcc.corner(), tolerance=1e-9)
    >>> saltus.mpcc(saltus._mpcc.corner(), start=p, first="branch").objective == p.objective
    True
    """
    from_x: list[float] = [] if start is None else _values(start)
    chosen = [option_of(name, value) for name, value in options.items() if value is not None]
    warned: list[str] = []
    with lines_of_problems(os.path.basename(os.fspath(path)), progress) as tell:
        try:
            found = _core.solve_mpcc(os.fspath(path), chosen, from_x, tell, warned)
        except BaseException as stopped:
            kept: typing.Any = getattr(stopped, "result", None)
            if isinstance(kept, tuple):
                stopped.result = Mpcc(kept)  # type: ignore[attr-defined]
            raise
    warn(warned)
    return Mpcc(found)


def _values(start: typing.Any) -> list[float]:
    try:
        x = np.asarray(start.x if isinstance(start, Mpcc) else start, dtype=float)
    except (TypeError, ValueError):
        raise refuse(f"start={start!r}: expected numbers, or an earlier result", "a value for every variable") from None
    if x.ndim != 1 or not np.isfinite(x).all():
        raise refuse(f"start: expected a list of finite numbers, found an array of shape {x.shape}", "a value for every variable")
    return x.tolist()  # type: ignore[no-any-return]

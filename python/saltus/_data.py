"""Results as tables of pandas and data sets of xarray."""

from __future__ import annotations

import typing
import zipfile

import numpy as np

from ._errors import needed
from ._recorded import Recorded


def frame(r: Recorded) -> typing.Any:
    """A row for every row of the result, with the time as its index."""
    pandas = needed("pandas", "data")
    columns = {name: np.array(r[name]) for name in r.names if name != "t"}
    return pandas.DataFrame(columns, index=pandas.Index(np.array(r.t), name="t"))


def dataset(r: Recorded, parameters: typing.Mapping[str, float], over: str) -> typing.Any:
    """Variables over `row`, of which `t` is a coordinate: two rows of one time, before and after an event, stay two.
    On a grid there is one row of each time, and `t` itself is the dimension."""
    xarray = needed("xarray", "data")
    variables = {name: (over, np.array(r[name])) for name in r.names if name != "t"}
    attributes = {
        "model": r.model,
        "method": r.method,
        "status": str(r.status),
        **{f"parameter.{name}": value for name, value in parameters.items()},
    }
    return xarray.Dataset(variables, coords={"t": (over, np.array(r.t))}, attrs=attributes)


def csv(columns: typing.Mapping[str, typing.Any]) -> str:
    """A table as RFC 4180 has it, numbers as the shortest text that reads back the same."""
    texts = [
        [_quoted(value) if isinstance(value, str) else _shortest(value) for value in _listed(values)]
        for values in columns.values()
    ]
    rows = [",".join(map(_quoted, columns)), *(",".join(row) for row in zip(*texts))]
    return "\n".join(rows) + "\n"


def write_arrays(path: str, columns: typing.Mapping[str, typing.Any]) -> None:
    """An archive of NumPy, with columns of any name."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        for name, values in columns.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                np.lib.format.write_array(file, np.asarray(values), allow_pickle=False)


def put_together(
    parts: typing.Sequence[typing.Mapping[str, typing.Any]], changed: int
) -> dict[str, np.ndarray[typing.Any, typing.Any]]:
    """Parts of a table one behind the other. A column that a part lacks has NaN in its rows, of words an empty one.

    The first column and the `changed` ones behind it are known by their place: a part in which no run began does not know
    which of them are states.

    >>> put_together([{"run": [1], "x": [2.0]}, {"run": [2]}], 0)["x"].tolist()
    [2.0, nan]
    """
    widest = max(parts, key=len)
    first = list(widest)[: 1 + changed]
    others = dict.fromkeys(name for part in parts for name in list(part)[1 + changed :])
    own = [list(part)[: 1 + changed] for part in parts]
    table = {}
    for name in (*first, *others):
        pieces = []
        for part, names in zip(parts, own):
            there = names[first.index(name)] if name in first else name
            pieces.append(np.asarray(part[there]) if there in part else None)
        table[name] = stacked(pieces, [len(part["run"]) for part in parts])
    return table


def stacked(
    pieces: typing.Sequence[typing.Any], rows: typing.Sequence[int]
) -> np.ndarray[typing.Any, typing.Any]:
    """Pieces of one column; None stands for one that is missing."""
    words = any(piece is not None and piece.dtype.kind in "UO" for piece in pieces)
    gap: typing.Any = "" if words else np.nan
    return np.concatenate([np.full(count, gap) if piece is None else piece for piece, count in zip(pieces, rows)])


def _listed(values: typing.Any) -> list[typing.Any]:
    return np.asarray(values).tolist()  # type: ignore[no-any-return]


def _shortest(value: float) -> str:
    return repr(value).removesuffix(".0")


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if set(text) & set(',"\n\r') else text

"""Results as tables of pandas and data sets of xarray."""

from __future__ import annotations

import numbers
import typing
import zipfile

import numpy as np

if typing.TYPE_CHECKING:
    from ._result import Result


def frame(r: Result, grid: typing.Any = None) -> typing.Any:
    """A row for every row of the result, or for every time of a grid, with the time as its index."""
    from ._result import needed

    pandas = needed("pandas", "data")
    r = with_rows(on_grid(r, grid))
    columns = {name: np.array(r[name]) for name in r.names if name != "t"}
    return pandas.DataFrame(columns, index=pandas.Index(np.array(r.t), name="t"))


def dataset(r: Result, grid: typing.Any = None) -> typing.Any:
    """Variables over `row`, of which `t` is a coordinate: two rows of one time, before and behind an event, stay two.
    On a grid there is one row of each time, and `t` itself is the dimension."""
    from ._result import needed

    xarray = needed("xarray", "data")
    parameters = r.parameters
    r = with_rows(on_grid(r, grid))
    over = "row" if grid is None else "t"
    variables = {name: (over, np.array(r[name])) for name in r.names if name != "t"}
    attributes = {
        "model": r.model,
        "method": r.method,
        "status": str(r.status),
        **{f"parameter.{name}": value for name, value in parameters.items()},
    }
    return xarray.Dataset(variables, coords={"t": (over, np.array(r.t))}, attrs=attributes)


def on_grid(r: Result, grid: typing.Any) -> Result:
    """The result at the times of a grid, or at so many at equal distances; without one as it is."""
    if grid is None:
        return r
    if np.ndim(grid) == 0 and (not isinstance(grid, numbers.Integral) or grid < 2):
        raise ValueError(f"grid={grid!r}: expected a whole number of rows from 2 on, or a list of times")
    return r.at(np.linspace(*r.span, int(grid)) if np.ndim(grid) == 0 else grid)


def with_rows(r: Result, least: int = 1) -> Result:
    """The result; a run of a sweep that kept no rows is simulated once more."""
    r = r if len(r.t) >= least else r.whole
    if len(r.t) < least:
        raise ValueError('this result has no trajectory: of a sweep ask for it with keep="trajectory"')
    return r


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


def _listed(values: typing.Any) -> list[typing.Any]:
    return np.asarray(values).tolist()  # type: ignore[no-any-return]


def _shortest(value: float) -> str:
    return repr(value).removesuffix(".0")


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if set(text) & set(',"\n\r') else text

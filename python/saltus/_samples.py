"""Data in memory where a model file names a file: samples of inputs, points of tables, rows of measurements."""

from __future__ import annotations

import typing

import numpy as np

from ._expression import refuse

Data = typing.Any  #: a pair of lists, an array, a dict of lists, a DataFrame or a Series
Array = np.ndarray[typing.Any, np.dtype[typing.Any]]
_TIMES = ("t", "times", "time")


def is_data(value: typing.Any) -> bool:
    """Whether a value is samples rather than a number or an expression."""
    if hasattr(value, "columns") and hasattr(value, "index") or hasattr(value, "index") and hasattr(value, "dtype"):
        return True
    if isinstance(value, typing.Mapping):
        return not set(value) & {"file", "result"}
    return isinstance(value, (list, tuple)) or isinstance(value, np.ndarray) and value.ndim > 0


def samples(what: str, name: str, value: Data) -> tuple[list[float], list[float]]:
    """Times and values of a control, which ascend and are as many: of a pair (t, u), a dict {"t": …, "u": …}, an array of
    two columns, a DataFrame with the columns t and the control's, or a Series over times.

    >>> samples("inputs", "u", ([0, 1], [2, 3]))
    ([0.0, 1.0], [2.0, 3.0])
    """
    times, values = _pair(what, name, value)
    return _together(what, times, values, "times", "values")


def _together(what: str, x: Data, y: Data, xs: str, ys: str) -> tuple[list[float], list[float]]:
    across, up = numbers(what, xs, x), numbers(what, ys, y)
    if len(across) != len(up):
        raise refuse(f"{what}: {len(across)} {xs} and {len(up)} {ys}", "every time has its value")
    if len(across) == 0:
        raise refuse(f"{what}: there are no {xs}", "give at least one")
    ascending(what, across, xs)
    return across.tolist(), up.tolist()


def numbers(what: str, part: str, values: Data) -> Array:
    """A list of finite numbers."""
    try:
        given = np.asarray(values)
        found = given.astype(float)
    except (TypeError, ValueError):
        raise refuse(f"{what}: the {part} are no numbers", "a list of numbers, e.g. [0, 0.5, 1]") from None
    if given.dtype.kind in "Mm":
        raise refuse(f"{what}: the {part} are dates", "a model counts time in numbers: (t - t[0]).total_seconds()")
    if found.ndim != 1:
        raise refuse(f"{what}: expected a list of {part}, found an array of shape {found.shape}", f"one number for each row")
    finite(what, found, part)
    return found


def finite(what: str, found: Array, part: str) -> None:
    """Refuses what is not finite, with its row."""
    bad = np.argwhere(~np.isfinite(found))
    if len(bad):
        row = int(bad[0][0])
        column = f", column {int(bad[0][1])}" if found.ndim > 1 else ""
        raise refuse(
            f"{what}: {found[tuple(bad[0])]} in row {row}{column} of the {part} (rows are counted from 0)",
            "expected finite numbers: leave the row out",
        )


def ascending(what: str, times: Array, part: str = "times") -> None:
    """Refuses times that do not ascend, with the row."""
    bad = np.flatnonzero(np.diff(times) <= 0)
    if len(bad):
        row = int(bad[0]) + 1
        raise refuse(
            f"{what}: the {part} must ascend, found {times[row]:g} in row {row} after {times[row - 1]:g} (rows are counted from 0)",
            "sort the rows, each time once",
        )


def _pair(what: str, name: str, value: Data) -> tuple[Data, Data]:
    if hasattr(value, "columns"):
        return _of_frame(what, name, value)
    if isinstance(value, typing.Mapping):
        return _of_mapping(what, name, value)
    if hasattr(value, "index") and hasattr(value, "dtype"):
        return value.index, value
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == 2:
        return value[:, 0], value[:, 1]
    if isinstance(value, (tuple, list)) and len(value) == 2 and np.ndim(value[0]) == 1:
        return value[0], value[1]
    shape = f"an array of shape {value.shape}" if isinstance(value, np.ndarray) else f"a {type(value).__name__} of {len(value)}"
    raise refuse(
        f"{what}: an input is no list of values, found {shape}",
        f'give times, too: {{"{name}": (times, values)}}; or an expression of t, "sin(t)"; or {{"file": "u.csv"}}',
    )


def _of_mapping(what: str, name: str, value: typing.Mapping[typing.Any, typing.Any]) -> tuple[Data, Data]:
    if value.get("kind") in ("linear", "cubic"):
        raise refuse(
            f"{what}: data of inputs are held from time to time, not joined",
            f'lines between them are a table of the model: [tables] load = {{ x = [0, 1], y = [2, 3] }}, then {{"{name}": "load(t)"}}; '
            'a Builder has b.table("load", times, values)',
        )
    times = next((key for key in _TIMES if key in value), None)
    values = next((key for key in (name, "u", "values") if key in value), None)
    if times is None or values is None or len(value) != 2:
        raise refuse(
            f'{what}: expected the keys "t" and "{name}", found {", ".join(map(repr, value)) or "none"}',
            f'write {{"{name}": {{"t": times, "{name}": values}}}}, or {{"{name}": (times, values)}}',
        )
    return value[times], value[values]


def times_of_frame(what: str, frame: typing.Any) -> Data:
    """The column of times of a DataFrame, or its index where that is called so or has numbers alone."""
    columns = list(frame.columns)
    times = next((key for key in _TIMES if key in columns), None)
    if times is not None:
        return frame[times]
    if frame.index.name in _TIMES or frame.index.dtype.kind == "f":
        return frame.index
    raise refuse(f"{what}: the DataFrame has no column 't'", f"name the column of times t; found {_listed(columns)}")


def _of_frame(what: str, name: str, frame: typing.Any) -> tuple[Data, Data]:
    columns = list(frame.columns)
    if name not in columns:
        raise refuse(f"{what}: the DataFrame has no column '{name}'", f"expected t and {name}, found {_listed(columns)}")
    return times_of_frame(what, frame), frame[name]


def _listed(names: typing.Iterable[typing.Any]) -> str:
    return ", ".join(map(str, names)) or "none"


def inputs_by_control(inputs: typing.Any) -> dict[str, typing.Any]:
    """What each control is: a DataFrame has a column for every one."""
    if hasattr(inputs, "columns"):
        names = [name for name in inputs.columns if name not in _TIMES]
        if not names:
            raise refuse("inputs: the DataFrame has no column but that of times", "a column for every control, and t")
        return {str(name): inputs for name in names}
    if not isinstance(inputs, typing.Mapping):
        raise refuse(f"inputs={inputs!r}: expected a dict", 'e.g. inputs={"u": "sin(t)"}, or {"u": (times, values)}')
    return {str(getattr(name, "text", name)): value for name, value in inputs.items()}


def of_result(what: str, name: str, result: typing.Any) -> tuple[list[float], list[float]]:
    """What a control of this name was in a result: of an optimisation a value per interval, else one per row."""
    if name not in result.controls:
        raise refuse(f"{what}: the result has no control '{name}'", f"it has {_listed(result.controls)}")
    column = result.controls.index(name)
    if result.optimization is not None:
        found = result.optimization
        return list(map(float, found["grid"][:-1])), [float(row[column]) for row in found["u"]]
    t = np.asarray(result.t)
    last = np.append(np.diff(t) > 0, True)  # of several rows at one time
    return t[last].tolist(), np.asarray(result.u)[last, column].tolist()


def rows(what: str, value: Data, width: int, names: typing.Sequence[str], times: Data = None) -> list[list[float]]:
    """Measurements, a row each with `width` numbers; with `times` these come first in every row.

    `value` is an array of that many columns, one list for one expression, or a DataFrame with columns of these names."""
    if hasattr(value, "columns"):
        missing = [name for name in names if name not in list(value.columns)]
        if missing:
            raise refuse(f"{what}: the DataFrame has no column '{missing[0]}'", f"found {_listed(value.columns)}")
        value = value[list(names)]
    try:
        found = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise refuse(f"{what}: these are no rows of numbers", "an array with a row for each time or interval") from None
    found = found.reshape(-1, 1) if found.ndim == 1 and width == 1 else found
    if found.ndim != 2 or found.shape[1] != width:
        raise refuse(f"{what}: expected an array of shape (rows, {width}), found {np.shape(value)}", "a column per expression")
    finite(what, found, "rows")
    if times is None:
        return found.tolist()  # type: ignore[no-any-return]
    at = numbers(what, "times", times)
    if len(at) != len(found):
        raise refuse(f"{what}: {len(at)} times and {len(found)} rows", "every time has its row")
    ascending(what, at)
    return np.column_stack([at, found]).tolist()  # type: ignore[no-any-return]


def file_text(name: str, value: typing.Any) -> str:
    """What a file of this name would have: text as it is, a DataFrame with the names of its columns, an array as rows."""
    if isinstance(value, str):
        return value
    head = ""
    if hasattr(value, "columns"):
        has_times = value.index.name in _TIMES
        head = ",".join(map(str, [*([value.index.name] if has_times else []), *value.columns])) + "\n"
        value = np.column_stack([value.index, value]) if has_times else value.to_numpy()
    elif isinstance(value, typing.Mapping):
        head, value = ",".join(map(str, value)) + "\n", np.column_stack(list(value.values()))
    elif isinstance(value, (tuple, list)) and len(value) and np.ndim(value[0]) == 1 and not isinstance(value, np.ndarray):
        value = np.column_stack(value)
    found = np.asarray(value, dtype=float)
    finite(name, found, "rows")
    lines = found.reshape(len(found), -1).tolist()
    return head + "".join(",".join(repr(number) for number in line) + "\n" for line in lines)

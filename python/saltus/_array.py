"""Arrays of expressions whose comparisons are arrays of conditions."""

from __future__ import annotations

import typing

import numpy as np

#: What numpy calls by these names does this instead: it would ask the entries for their truth at once.
_INSTEAD: dict[str, typing.Callable[..., typing.Any]] = {}
_COMPARISONS = frozenset({"greater", "greater_equal", "less", "less_equal", "equal", "not_equal"})


class Array(np.ndarray[typing.Any, np.dtype[typing.Any]]):
    """An array of numpy whose entries are expressions; made by :func:`saltus.array` and whatever is computed with one.

    >>> m = saltus.Builder("m")
    >>> X = saltus.array([m.state("x", 0), m.state("v", 1)])
    >>> X > 0
    Array([x>0, v>0], dtype=object)
    >>> saltus.if_((X > 0) & (X < 1), -X, 0)
    Array([if(x>0 and x<1,-x,0), if(v>0 and v<1,-v,0)], dtype=object)
    """

    #: Above that of an expression, so that X > x is not turned round.
    __array_priority__ = 2000

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: typing.Any, **kwargs: typing.Any) -> typing.Any:
        plain = [_plain(value) for value in inputs]
        if kwargs.get("out") is not None:
            kwargs["out"] = tuple(_plain(value) for value in kwargs["out"])
        instead = _INSTEAD.get(ufunc.__name__)
        if ufunc is np.matmul and instead is not None:
            made = instead(*plain) if method == "__call__" and not kwargs else NotImplemented
            if made is not NotImplemented:
                return own(made)
        elif instead is not None:
            ufunc = np.frompyfunc(instead, ufunc.nin, 1)
            kwargs.pop("dtype", None)
        elif ufunc.__name__ in _COMPARISONS and method == "__call__":
            kwargs["dtype"] = object
        return own(getattr(ufunc, method)(*plain, **kwargs))

    def __array_function__(
        self, func: typing.Any, types: typing.Any, args: typing.Any, kwargs: typing.Any
    ) -> typing.Any:
        if func is np.where and len(args) == 3 and isinstance(args[0], Array):
            return own(np.frompyfunc(_INSTEAD["where"], 3, 1)(*map(_plain, args)))
        return own(super().__array_function__(func, types, args, kwargs))


def _plain(value: typing.Any) -> typing.Any:
    return value.view(np.ndarray) if isinstance(value, Array) else value


def own(value: typing.Any) -> typing.Any:
    """An array of objects as one whose comparisons are conditions; everything else as it is."""
    return value.view(Array) if isinstance(value, np.ndarray) and value.dtype == object else value


def instead(**functions: typing.Callable[..., typing.Any]) -> None:
    """Says what functions of numpy do with entries, by the names of numpy."""
    _INSTEAD.update(functions)


def array(entries: typing.Any) -> Array:
    """An array of expressions, as ``numpy.array`` makes it, whose comparisons are arrays of conditions.

    >>> m = saltus.Builder("m")
    >>> x, v = m.state("x", 0), m.state("v", 1)
    >>> saltus.array([x, v]) <= saltus.array([1, x])
    Array([x<=1, v<=x], dtype=object)
    """
    if type(entries).__module__.startswith("casadi"):
        entries = [entries[i] for i in range(entries.numel())]
    return np.array(entries, dtype=object).view(Array)

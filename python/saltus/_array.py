"""Arrays of expressions whose comparisons are arrays of conditions."""

from __future__ import annotations

import re
import sys
import typing

import numpy as np

from ._errors import ModelError

#: What numpy calls by these names does this instead: it would ask the entries for their truth at once.
_INSTEAD: dict[str, typing.Callable[..., typing.Any]] = {}
#: Functions of numpy that expressions do not have, and what to write.
_WRITTEN = {
    **dict.fromkeys(("round", "around", "rint"), "saltus.floor(x + 0.5), of times only"),
    **dict.fromkeys(("trunc", "fix"), "saltus.floor(x), of times only"),
    **dict.fromkeys(("select", "piecewise", "digitize"), "saltus.if_(x > 1, a, saltus.if_(x > 0, b, c))"),
    **dict.fromkeys(("isclose", "allclose"), "a condition of both sides: (x > a) & (x < b)"),
    **dict.fromkeys(("isnan", "isinf", "isfinite"), "nothing: a run ends where a value is no finite number"),
    **dict.fromkeys(
        ("inv", "solve", "det"),
        "the formula, as (d*p - b*q)/(a*d - b*c) of two equations; of a matrix of numbers np.linalg.inv(A) @ X",
    ),
    **dict.fromkeys(("trapezoid", "trapz"), 'an integral is a state: z = m.state("z", 0), m.rate(z, …) of what is integrated'),
    "gradient": "the quotients: (x[2:] - x[:-2])/(2*h), with x = saltus.array(x)",
    **dict.fromkeys(("linspace", "arange"), "numbers: their ends are known before the simulation only"),
    "interp": 'road = m.table("road", x=[0, 1], y=[0, 2]), then road(x)',
    "ceil": "-saltus.floor(-x), of times only",
    "cbrt": "saltus.sign(x)*abs(x)**(1/3)",
    "expm1": "saltus.exp(x) - 1",
    "exp2": "2**x",
    "log1p": "saltus.log(1 + x)",
    "log2": "saltus.log(x)/saltus.log(2)",
}
#: What numpy says of entries for which it has no function.
_NO_FUNCTION = re.compile("ufunc|dtype|attribute|boolean ndarray")
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
        if ufunc is np.matmul and len(inputs) == 2 and is_sparse(inputs[1]):
            return (Sparse(inputs[1]).T @ inputs[0].T).T
        _check_known(ufunc)
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
        return own(_computed(ufunc, lambda: getattr(ufunc, method)(*plain, **kwargs)))

    def __array_function__(
        self, func: typing.Any, types: typing.Any, args: typing.Any, kwargs: typing.Any
    ) -> typing.Any:
        if func is np.ravel and sys._getframe(2).f_globals.get("__name__", "").startswith("scipy.sparse"):
            raise TypeError("a matrix of scipy.sparse cannot multiply expressions: write saltus.array(A) @ X")
        if func is np.where and len(args) == 3 and isinstance(args[0], Array):
            return own(np.frompyfunc(_INSTEAD["where"], 3, 1)(*map(_plain, args)))
        _check_known(func)
        return own(_computed(func, lambda: super(Array, self).__array_function__(func, types, args, kwargs)))


def _refusal(function: typing.Any) -> ModelError:
    name = function.__name__
    others = "it with functions of the language, saltus.sin, saltus.max, saltus.if_, …; numpy computes with numbers, before"
    message, remedy = f"numpy.{name} is no function of expressions", f"write {_WRITTEN.get(name, others)}"
    return ModelError(f"{message}\n  {remedy}", message, remedy)


def _check_known(function: typing.Any) -> None:
    if function.__name__ in _WRITTEN:
        raise _refusal(function)


def _computed(function: typing.Any, compute: typing.Callable[[], typing.Any]) -> typing.Any:
    """What numpy computes with entries; where it finds no such function among theirs that is said in our words."""
    try:
        return compute()
    except (TypeError, AttributeError) as failure:
        if not _NO_FUNCTION.search(str(failure)):
            raise
        raise _refusal(function) from failure


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
    if is_sparse(entries):
        return Sparse(entries)  # type: ignore[return-value]
    found = entries_of(entries)
    return np.array(entries if found is None else found, dtype=object).view(Array)


def entries_of(matrix: typing.Any) -> typing.Any:
    """Entries of a matrix of another package as lists, of a column as one list; None of what is no such matrix."""
    if is_sparse(matrix):
        return matrix.toarray().tolist()
    package = type(matrix).__module__.partition(".")[0]
    if package == "casadi" and hasattr(matrix, "numel"):
        rows, columns = matrix.shape
        if columns == 1:
            return [matrix[i] for i in range(rows)]
        return [[matrix[i, j] for j in range(columns)] for i in range(rows)]
    if package == "sympy" and hasattr(matrix, "tolist"):
        rows = matrix.tolist()
        return [row[0] for row in rows] if matrix.shape[1] == 1 else rows
    return None


def is_sparse(matrix: typing.Any) -> bool:
    """Whether it is a matrix of scipy.sparse."""
    return type(matrix).__module__.startswith("scipy.sparse") and hasattr(matrix, "tocoo")


class Sparse:
    """A matrix of scipy.sparse that multiplies arrays of expressions: only its entries are in the sums.

    >>> import scipy.sparse  # doctest: +SKIP
    >>> saltus.array(scipy.sparse.eye(2)) @ saltus.Builder("m").states("x", [0, 1])  # doctest: +SKIP
    Array([x1, x2], dtype=object)
    """

    def __init__(self, matrix: typing.Any) -> None:
        self.matrix = matrix.tocsr()
        self.shape: tuple[int, ...] = self.matrix.shape

    @property
    def T(self) -> Sparse:
        """The transpose."""
        return Sparse(self.matrix.T)

    def __matmul__(self, other: typing.Any) -> typing.Any:
        right = np.asarray(other, dtype=object)
        if right.ndim not in (1, 2) or right.shape[0] != self.shape[1]:
            raise ValueError(f"a sparse matrix of shape {self.shape} times an array of shape {right.shape}: expected {self.shape[1]} rows")
        columns = right.reshape(right.shape[0], -1)
        made = np.empty((self.shape[0], columns.shape[1]), dtype=object)
        begin, places, values = self.matrix.indptr, self.matrix.indices, self.matrix.data
        for i in range(self.shape[0]):
            row = range(begin[i], begin[i + 1])
            for j in range(columns.shape[1]):
                made[i, j] = _sum(_times(values[k], columns[places[k], j]) for k in row)
        return made.reshape(self.shape[0], *right.shape[1:]).view(Array)

    def __repr__(self) -> str:
        return f"<saltus matrix of shape {self.shape}, {self.matrix.nnz} entries>"


def _times(factor: typing.Any, entry: typing.Any) -> typing.Any:
    return entry if factor == 1 else -entry if factor == -1 else float(factor) * entry


def _sum(terms: typing.Iterable[typing.Any]) -> typing.Any:
    total: typing.Any = None
    for term in terms:
        total = term if total is None else total + term
    return 0 if total is None else total

"""Expressions of the language of model files, made with the operators of Python.

An expression is its text, with the parentheses that are needed: what is built from it is what the same text in a file is.
"""

from __future__ import annotations

import functools
import math
import numbers
import typing

import numpy as np

from . import _array
from ._errors import ModelError

OR, AND, NOT, COMPARISON, SUM, PRODUCT, SIGN, POWER, PRIMARY = range(1, 10)
Operand = typing.Any  #: an Expression or a number
Owner = typing.Optional[object]


def refuse(message: str, remedy: str) -> ModelError:
    """A mistake that was made in Python."""
    return ModelError(f"{message}\n  {remedy}", message, remedy)


class Expression:
    """A number of the model (``x + 1``) or a condition (``x > 1``); made by a Builder and by functions of the language.

    >>> m = saltus.Builder("m")
    >>> x, v = m.state("x", 0), m.state("v", 1)
    >>> -(x - 2 * v) ** 2 / saltus.sign(v)
    -(x-2*v)^2/sign(v)
    >>> (x > 0) & ~(v <= x)
    x>0 and not v<=x
    """

    __slots__ = ("text", "level", "is_condition", "owner")
    __array_priority__ = 1000

    def __init__(self, text: str, level: int = PRIMARY, is_condition: bool = False, owner: Owner = None) -> None:
        self.text = text
        self.level = level
        self.is_condition = is_condition
        self.owner = owner

    def __repr__(self) -> str:
        return self.text

    __str__ = __repr__

    def __hash__(self) -> int:
        return id(self)

    # Numbers -------------------------------------------------------------------------------------------------------

    def __add__(self, other: Operand) -> Expression:
        return _binary("+", self, other, SUM)

    def __radd__(self, other: Operand) -> Expression:
        return _binary("+", other, self, SUM)

    def __sub__(self, other: Operand) -> Expression:
        return _binary("-", self, other, SUM)

    def __rsub__(self, other: Operand) -> Expression:
        return _binary("-", other, self, SUM)

    def __mul__(self, other: Operand) -> Expression:
        return _binary("*", self, other, PRODUCT)

    def __rmul__(self, other: Operand) -> Expression:
        return _binary("*", other, self, PRODUCT)

    def __truediv__(self, other: Operand) -> Expression:
        return _binary("/", self, other, PRODUCT)

    def __rtruediv__(self, other: Operand) -> Expression:
        return _binary("/", other, self, PRODUCT)

    def __pow__(self, other: Operand) -> Expression:
        return _power(self, other)

    def __rpow__(self, other: Operand) -> Expression:
        return _power(other, self)

    def __mod__(self, other: Operand) -> typing.Any:
        return mod(self, other)

    def __rmod__(self, other: Operand) -> typing.Any:
        return mod(other, self)

    def __floordiv__(self, other: Operand) -> typing.Any:
        return floor(self / other)

    def __rfloordiv__(self, other: Operand) -> typing.Any:
        return floor(other / self)

    def __neg__(self) -> Expression:
        return _make("-" + _inside(self, SIGN), SIGN, False, self)

    def __pos__(self) -> Expression:
        return _make("+" + _inside(self, SIGN), SIGN, False, self)

    def __abs__(self) -> typing.Any:
        return abs(self)

    # Conditions ----------------------------------------------------------------------------------------------------

    def __lt__(self, other: Operand) -> Expression:
        return _comparison("<", self, other)

    def __le__(self, other: Operand) -> Expression:
        return _comparison("<=", self, other)

    def __gt__(self, other: Operand) -> Expression:
        return _comparison(">", self, other)

    def __ge__(self, other: Operand) -> Expression:
        return _comparison(">=", self, other)

    def __eq__(self, other: object) -> Expression:  # type: ignore[override]
        return _comparison("==", self, other)

    def __ne__(self, other: object) -> Expression:  # type: ignore[override]
        return _comparison("!=", self, other)

    def __and__(self, other: Operand) -> Expression:
        return _logical(" and ", self, other, AND)

    def __rand__(self, other: Operand) -> Expression:
        return _logical(" and ", other, self, AND)

    def __or__(self, other: Operand) -> Expression:
        return _logical(" or ", self, other, OR)

    def __ror__(self, other: Operand) -> Expression:
        return _logical(" or ", other, self, OR)

    def __invert__(self) -> Expression:
        _condition(self, "~")
        return _make("not " + _inside(self, NOT), NOT, True, self)

    # What Python must not decide -----------------------------------------------------------------------------------

    def __bool__(self) -> bool:
        if self.is_condition:
            raise refuse(
                f"Python cannot decide whether {self.text} holds: that changes during the simulation",
                "write saltus.if_(condition, a, b) for `if`, & | ~ for `and or not`, (a < x) & (x < b) for a < x < b, "
                "saltus.max, saltus.min and saltus.sign for those of Python and numpy, and compare arrays that are made by "
                "saltus.array: saltus.array([x, v]) > 0",
            )
        raise refuse(f"{self.text} is no condition", "compare it: x > 0")

    def __float__(self) -> float:
        raise refuse(
            f"{self.text} has no value before the simulation",
            "functions of math take numbers only: write saltus.sin, saltus.exp, …",
        )

    __int__ = __index__ = __float__

    def __iter__(self) -> typing.Iterator[Expression]:
        raise refuse(f"{self.text} is one number", "arrays of expressions: saltus.array([x, v])")


def _functions_for_numpy() -> None:
    """np.sin of an array of expressions calls the method sin of its entries, np.arctan2 of two arctan2 of the first."""
    for name, own in (("arctan2", "atan2"), ("hypot", "hypot")):
        setattr(Expression, name, lambda self, other, own=own: call(own, self, other))
    for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "log10", "sqrt", "floor", "sign"):
        setattr(Expression, name, lambda self, name=name: call(name, self))
    for name, own in (("arcsin", "asin"), ("arccos", "acos"), ("arctan", "atan")):
        setattr(Expression, name, lambda self, own=own: call(own, self))


def expression(value: Operand) -> Expression:
    """A number as an expression."""
    if isinstance(value, Expression):
        return value
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return expression(value.item())
    if type(value).__module__.startswith("casadi"):
        return _of_casadi(value)
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise refuse(
            f"expected a number or an expression, found {value!r}",
            'expressions are scalar; of arrays: m.states("x", [1, 0]), m.rate(X, A @ X), or entry by entry',
        )
    if isinstance(value, numbers.Integral):
        text = str(int(value))
    else:
        number = float(value)
        if not math.isfinite(number):
            raise refuse(f"{number} is no number of a model", "write a finite number")
        text = repr(number).replace("e-0", "e-").replace("e+", "e")
    return Expression(text, SIGN if text.startswith("-") else PRIMARY)


def _of_casadi(value: typing.Any) -> Expression:
    """An SX of CasADi, whose symbols have the names of the model: x + casadi.SX.sym("a") is x+a."""
    if type(value).__name__ not in ("SX", "DM") or value.numel() != 1:
        raise refuse(
            f"expected a scalar SX of CasADi, found {type(value).__name__}",
            "make it of casadi.SX.sym with the names of states and parameters, entry by entry",
        )
    if type(value).__name__ == "DM":
        return expression(float(value))
    import casadi

    return Expression(_casadi_text(casadi, value), SUM)


#: Operations of CasADi by their names, in the language of models.
_CASADI = {
    "OP_ADD": "({}+{})", "OP_SUB": "({}-{})", "OP_MUL": "({}*{})", "OP_DIV": "({}/{})", "OP_NEG": "(-{})",
    "OP_INV": "(1/{})", "OP_SQ": "({})^2", "OP_TWICE": "(2*{})", "OP_POW": "({})^({})", "OP_CONSTPOW": "({})^({})",
    "OP_EXP": "exp({})", "OP_LOG": "log({})", "OP_SQRT": "sqrt({})", "OP_SIN": "sin({})", "OP_COS": "cos({})",
    "OP_TAN": "tan({})", "OP_ASIN": "asin({})", "OP_ACOS": "acos({})", "OP_ATAN": "atan({})", "OP_SINH": "sinh({})",
    "OP_COSH": "cosh({})", "OP_TANH": "tanh({})", "OP_ATAN2": "atan2({},{})", "OP_HYPOT": "hypot({},{})",
    "OP_FABS": "abs({})", "OP_SIGN": "sign({})", "OP_FMIN": "min({},{})", "OP_FMAX": "max({},{})",
    "OP_FLOOR": "floor({})",
}  # fmt: skip


def _casadi_text(casadi: typing.Any, value: typing.Any) -> str:
    if value.is_symbolic():
        return str(value.name())
    if value.is_constant():
        return expression(float(value)).text
    names = {getattr(casadi, name): name for name in _CASADI}
    name = names.get(value.op())
    if name is None:
        raise refuse(f"{value} has an operation that models do not", "write it with the functions of saltus")
    return _CASADI[name].format(*(_casadi_text(casadi, value.dep(k)) for k in range(value.n_dep())))


def owner_of(*operands: Operand) -> Owner:
    """The builder of all of them; refuses two."""
    owner: Owner = None
    for operand in operands:
        theirs = operand.owner if isinstance(operand, Expression) else None
        if theirs is not None and owner is not None and theirs is not owner:
            raise refuse(f"{operand.text} belongs to another builder", "a model is made of the names of one builder")
        owner = owner if theirs is None else theirs
    return owner


def _inside(operand: Expression, level: int) -> str:
    return operand.text if operand.level >= level else f"({operand.text})"


def _make(text: str, level: int, is_condition: bool, *operands: Expression) -> Expression:
    return Expression(text, level, is_condition, owner_of(*operands))


Made = typing.TypeVar("Made", bound=typing.Callable[..., typing.Any])


def _entry_by_entry(make: Made) -> Made:
    """Of operands among which are arrays: an array of what is made of their entries."""

    @functools.wraps(make)
    def made(*operands: Operand) -> typing.Any:
        if not any(isinstance(operand, np.ndarray) and operand.ndim > 0 for operand in operands):
            return make(*operands)
        entries = [operand if isinstance(operand, np.ndarray) else _one(operand) for operand in operands]
        return _array.own(np.frompyfunc(make, len(operands), 1)(*entries))

    return typing.cast(Made, made)


def _one(operand: Operand) -> np.ndarray:
    """An operand as an array that has no axis."""
    entry = np.empty((), dtype=object)
    entry[()] = operand
    return entry


@_entry_by_entry
def _binary(sign: str, left: Operand, right: Operand, level: int) -> Expression:
    a, b = expression(left), expression(right)
    return _make(_inside(a, level) + sign + _inside(b, level + 1), level, False, a, b)


@_entry_by_entry
def _power(base: Operand, exponent: Operand) -> Expression:
    a, b = expression(base), expression(exponent)
    return _make(f"{_inside(a, PRIMARY)}^{_inside(b, SIGN)}", POWER, False, a, b)


@_entry_by_entry
def _comparison(sign: str, left: Operand, right: Operand) -> Expression:
    a, b = expression(left), expression(right)
    return _make(_inside(a, SUM) + sign + _inside(b, SUM), COMPARISON, True, a, b)


def _condition(value: Operand, sign: str) -> Expression:
    if isinstance(value, Expression) and value.is_condition:
        return value
    raise refuse(
        f"{sign} joins conditions, found {value!r}",
        "Python's & and | bind tighter than comparisons: write (x > 0) & (y > 0)",
    )


@_entry_by_entry
def _logical(word: str, left: Operand, right: Operand, level: int) -> Expression:
    a, b = _condition(left, word.strip()), _condition(right, word.strip())
    return _make(_inside(a, level) + word + _inside(b, level + 1), level, True, a, b)


@_entry_by_entry
def call(function: str, *arguments: Operand) -> typing.Any:
    """A function of the language; of arrays entry by entry."""
    made = [expression(argument) for argument in arguments]
    return _make(f"{function}({','.join(argument.text for argument in made)})", PRIMARY, False, *made)


def _function(name: str, count: int, text: str) -> typing.Callable[..., typing.Any]:
    def function(*arguments: Operand) -> typing.Any:
        if len(arguments) != count:
            remedy = f"one in the other: {name}({name}(a, b), c)" if name in ("max", "min") else text
            raise refuse(f"{name} has {count} argument{'s' * (count > 1)}, found {len(arguments)}", remedy)
        return call(name, *arguments)

    function.__name__ = function.__qualname__ = name
    function.__doc__ = text
    return function


sin = _function("sin", 1, "The sine, of radians.")
cos = _function("cos", 1, "The cosine, of radians.")
tan = _function("tan", 1, "The tangent, of radians.")
asin = _function("asin", 1, "The inverse of the sine.")
acos = _function("acos", 1, "The inverse of the cosine.")
atan = _function("atan", 1, "The inverse of the tangent.")
atan2 = _function("atan2", 2, "The angle of the point (x, y): atan2(y, x).")
sinh = _function("sinh", 1, "The hyperbolic sine.")
cosh = _function("cosh", 1, "The hyperbolic cosine.")
tanh = _function("tanh", 1, "The hyperbolic tangent.")
exp = _function("exp", 1, "The exponential.")
log = _function("log", 1, "The natural logarithm.")
log10 = _function("log10", 1, "The logarithm to base 10.")
sqrt = _function("sqrt", 1, "The square root.")
pow = _function("pow", 2, "The first to the power of the second.")
hypot = _function("hypot", 2, "sqrt(a^2 + b^2).")
step = _function("step", 1, "1 where e > 0, 0 where e < 0, between them on the surface e = 0.")
sign = _function("sign", 1, "1 where e > 0, -1 where e < 0, between them on the surface e = 0.")
abs = _function("abs", 1, "The absolute value.")
max = _function("max", 2, "The larger one of two.")
min = _function("min", 2, "The smaller one of two.")
floor = _function("floor", 1, "The largest integer not above e, an expression of time and parameters.")
mod = _function("mod", 2, "e - m floor(e/m).")


@_entry_by_entry
def if_(condition: Operand, a: Operand, b: Operand) -> Expression:
    """`a` where the condition holds, else `b`.

    >>> m = saltus.Builder("m")
    >>> x = m.state("x", 0)
    >>> saltus.if_(x > 1, -x, 2)
    if(x>1,-x,2)
    """
    if not isinstance(condition, Expression) or not condition.is_condition:
        raise refuse(f"if_ needs a condition, found {condition!r}", "compare: saltus.if_(x > 0, a, b)")
    made = [condition, expression(a), expression(b)]
    return _make(f"if({','.join(part.text for part in made)})", PRIMARY, False, *made)


t = Expression("t")
pi = Expression("pi")
_functions_for_numpy()
_array.instead(
    maximum=max, minimum=min, fmax=max, fmin=min, sign=sign, where=if_, clip=lambda x, low, high: min(max(x, low), high),
    logical_and=lambda a, b: a & b, logical_or=lambda a, b: a | b, logical_not=lambda a: ~a,
)  # fmt: skip

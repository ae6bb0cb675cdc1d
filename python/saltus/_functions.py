"""The functions of the language of model files, for numbers, expressions and arrays of them."""

from __future__ import annotations

import functools
import typing

from . import _array
from ._expression import Expression, Operand, call, called, entry_by_entry, number, refuse
from ._expression import condition as as_condition
from ._sums import product


def _function(name: str, count: int, text: str, argument: str = "x") -> typing.Callable[..., typing.Any]:
    def function(*arguments: Operand) -> typing.Any:
        if name in ("max", "min") and len(arguments) > 2:
            return functools.reduce(function, arguments)
        if name in ("max", "min") and len(arguments) == 1:
            raise refuse(f"{name} has 2 arguments or more, found 1", f"of a list: saltus.{name}(*values)")
        if len(arguments) != count:
            raise refuse(f"{name} has {count} argument{'s' * (count > 1)}, found {len(arguments)}", text)
        return call(name, *arguments)

    function.__name__ = function.__qualname__ = name
    written = argument if count == 1 else f"{argument}, 2"
    function.__doc__ = f"""{text}

    >>> x, t = saltus.Builder("m").state("x", 1), saltus.t
    >>> saltus.{name}({written})
    {name}({written.replace(" ", "")})
    """
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
max = _function("max", 2, "The largest one of two or more.")
min = _function("min", 2, "The smallest one of two or more.")
floor = _function("floor", 1, "The largest integer not above e, an expression of time and parameters.", "t")
mod = _function("mod", 2, "e - m floor(e/m), of an expression of time and parameters; of others for outputs only.", "t")
initial = _function(
    "initial", 1, "A state at the start of the horizon, in terminal constraints and costs of ``optimize``.", "x"
)


@entry_by_entry
def if_(condition: Operand, a: Operand, b: Operand) -> Expression:
    """`a` where the condition holds, else `b`.

    >>> m = saltus.Builder("m")
    >>> x = m.state("x", 0)
    >>> saltus.if_(x > 1, -x, 2)
    if(x>1,-x,2)
    """
    holds = as_condition(condition, "if_ needs a condition", "compare: saltus.if_(x > 0, a, b)")
    return called("if", holds, number(a), number(b))


t = Expression("t")
pi = Expression("pi")
_array.instead(
    maximum=max, minimum=min, fmax=max, fmin=min, sign=sign, where=if_, clip=lambda x, low, high: min(max(x, low), high),
    heaviside=lambda x, _: step(x), logical_and=lambda a, b: a & b, logical_or=lambda a, b: a | b, logical_not=lambda a: ~a,
    matmul=product,
)  # fmt: skip


def _method_for_numpy(name: str, own: str, count: int) -> None:
    """numpy.sin of an expression, or of an array of them, calls their method sin."""

    def method(self: Expression, *other: Operand) -> typing.Any:
        return call(own, self, *other)

    written = "x" if count == 1 else "x, 2"
    method.__name__, method.__qualname__ = name, f"Expression.{name}"
    method.__doc__ = f"""What numpy.{name} calls: :func:`saltus.{own}`.

    >>> x = saltus.Builder("m").state("x", 1)
    >>> x.{name}({written[3:]})
    {own}({written.replace(" ", "")})
    """
    setattr(Expression, name, method)


for _name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "exp", "log", "log10", "sqrt", "floor", "sign"):
    _method_for_numpy(_name, _name, 1)
for _name, _own in (("arcsin", "asin"), ("arccos", "acos"), ("arctan", "atan"), ("fabs", "abs")):
    _method_for_numpy(_name, _own, 1)
for _name, _own in (("arctan2", "atan2"), ("hypot", "hypot")):
    _method_for_numpy(_name, _own, 2)

"""Expressions of SymPy as expressions of models."""

from __future__ import annotations

import functools
import operator
import typing

from ._expression import Expression, call, expression, number, reads, refuse
from ._functions import if_, step

#: Functions of SymPy whose name is another one here, or that are made of others.
_FUNCTIONS: dict[str, typing.Callable[..., typing.Any]] = {
    "Abs": functools.partial(call, "abs"),
    "Heaviside": lambda x, *_: step(x),
    "ceiling": lambda x: -call("floor", -x),
    "Mod": functools.partial(call, "mod"),
    "Min": lambda *all_of: functools.reduce(functools.partial(call, "min"), all_of),
    "Max": lambda *all_of: functools.reduce(functools.partial(call, "max"), all_of),
    "log": lambda x, *base: call("log", x) / call("log", base[0]) if base else call("log", x),
    "cot": lambda x: 1 / call("tan", x),
    "sec": lambda x: 1 / call("cos", x),
    "csc": lambda x: 1 / call("sin", x),
    **{name: functools.partial(call, name) for name in (
        "exp", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "sign", "floor")},
}  # fmt: skip
_RELATIONS: dict[str, typing.Callable[..., typing.Any]] = {
    "StrictLessThan": operator.lt, "LessThan": operator.le, "StrictGreaterThan": operator.gt, "GreaterThan": operator.ge,
    "Equality": operator.eq, "Unequality": operator.ne,
}  # fmt: skip


def of_sympy(value: typing.Any) -> Expression:
    """A scalar of SymPy, whose symbols, and functions of time, have the names of the model: Symbol("x") + 1 is x+1."""
    kind = type(value).__name__
    if value.is_Symbol or kind == "Symbol":
        return Expression(str(value.name))
    if hasattr(value, "is_Number") and value.is_Number:
        return _number(value)
    if kind in ("Pi", "Exp1", "NumberSymbol") or getattr(value, "is_NumberSymbol", False):
        return Expression("pi") if kind == "Pi" else expression(float(value))
    if getattr(value, "is_Add", False):
        return _folded(operator.add, value.args)
    if getattr(value, "is_Mul", False):
        return _product(value)
    if getattr(value, "is_Pow", False):
        return _power(value)
    if kind == "Piecewise":
        return _piecewise(value)
    if kind in ("And", "Or"):
        return _folded(operator.and_ if kind == "And" else operator.or_, value.args)
    if kind == "Not":
        return ~of_sympy(value.args[0])
    if kind in _RELATIONS:
        return _RELATIONS[kind](*map(of_sympy, value.args))  # type: ignore[no-any-return]
    if kind in _FUNCTIONS:
        return _FUNCTIONS[kind](*map(of_sympy, value.args))  # type: ignore[no-any-return]
    if type(value).__bases__ and getattr(value, "is_Function", False) and hasattr(value, "name"):
        return Expression(str(value.name))  # x(t): a function of time that is a state
    if getattr(value, "is_Matrix", False):
        raise refuse(f"expected a scalar of SymPy, found a matrix of shape {value.shape}", "saltus.array(matrix)")
    raise refuse(f"{str(value)[:60]}: models have no '{kind}' of SymPy", "write it with the functions of saltus")


def _number(value: typing.Any) -> Expression:
    if value.is_Integer:
        return expression(int(value))
    if value.is_Rational:
        return expression(int(value.p)) / expression(int(value.q))
    return expression(float(value))


def _folded(join: typing.Callable[..., typing.Any], terms: typing.Iterable[typing.Any]) -> Expression:
    """Terms one after the other; a negative one is subtracted."""
    made: Expression | None = None
    for term in terms:
        negative = join is operator.add and made is not None and term.could_extract_minus_sign()
        one = of_sympy(-term if negative else term)
        made = one if made is None else made - one if negative else join(made, one)
    return expression(0) if made is None else made


def _product(value: typing.Any) -> Expression:
    above, below = value.as_numer_denom()
    if below != 1 and not value.is_commutative:
        raise refuse(f"{value}: its factors do not commute", "models have real numbers")
    if below == 1:
        made: Expression | None = None
        for factor in above.as_ordered_factors() if above.is_Mul else [above]:
            if factor == -1 and made is None:
                return -_folded(operator.mul, [one for one in above.args if one != -1])
            made = of_sympy(factor) if made is None else made * of_sympy(factor)
        return expression(1) if made is None else made
    return of_sympy(above) / of_sympy(below)


def _power(value: typing.Any) -> Expression:
    base, exponent = value.as_base_exp()
    if exponent.is_Rational and exponent.q == 2 and exponent.p in (1, -1):
        root: Expression = call("sqrt", of_sympy(base))
        return root if exponent.p == 1 else 1 / root
    if exponent == -1:
        return 1 / of_sympy(base)
    if type(base).__name__ == "Exp1":
        return call("exp", of_sympy(exponent))  # type: ignore[no-any-return]
    return of_sympy(base) ** of_sympy(exponent)


def _piecewise(value: typing.Any) -> Expression:
    *pieces, (last, condition) = value.args
    if condition != True:  # noqa: E712  (the truth of SymPy)
        raise refuse(f"{str(value)[:60]}: nothing holds where no condition does", "end it with (value, True)")
    made = of_sympy(last)
    for piece, where in reversed(pieces):
        made = if_(of_sympy(where), number(of_sympy(piece)), made)
    return made


reads("sympy", of_sympy)

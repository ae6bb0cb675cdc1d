"""Expressions of CasADi as expressions of models."""

from __future__ import annotations

import functools
import operator
import typing

from ._expression import Expression, call, expression, number, reads, refuse
from ._functions import if_


def of_casadi(value: typing.Any) -> Expression:
    """An SX of CasADi, whose symbols have the names of the model: x + casadi.SX.sym("a") is x+a."""
    kind = type(value).__name__
    if kind not in ("SX", "DM"):
        raise refuse(f"expected a scalar SX of CasADi, found {kind}", "make it of casadi.SX.sym")
    if value.numel() != 1:
        raise refuse(f"expected a scalar SX of CasADi, found one of {value.numel()} entries", "take them entry by entry")
    if kind == "DM":
        return expression(float(value))
    import casadi

    return _of_instructions(casadi, value)


def _function(name: str) -> typing.Callable[..., typing.Any]:
    return functools.partial(call, name)


#: What operations of CasADi, by their names, are here.
_OPERATIONS: dict[str, typing.Callable[..., typing.Any]] = {
    "OP_ADD": operator.add, "OP_SUB": operator.sub, "OP_MUL": operator.mul, "OP_DIV": operator.truediv,
    "OP_NEG": operator.neg, "OP_INV": lambda a: 1 / a, "OP_SQ": lambda a: a**2, "OP_TWICE": lambda a: 2 * a,
    "OP_POW": operator.pow, "OP_CONSTPOW": operator.pow, "OP_FABS": _function("abs"), "OP_FMIN": _function("min"),
    "OP_FMAX": _function("max"), "OP_CEIL": lambda a: -call("floor", -a),
    **{f"OP_{name.upper()}": _function(name) for name in (
        "exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "atan2", "hypot",
        "sign", "floor")},
    "OP_LT": operator.lt, "OP_LE": operator.le, "OP_EQ": operator.eq, "OP_NE": operator.ne,
}  # fmt: skip
_LOGICAL: dict[str, typing.Callable[..., Expression]] = {
    "OP_NOT": operator.invert, "OP_AND": operator.and_, "OP_OR": operator.or_,
}  # fmt: skip
_CHOICE = "OP_IF_ELSE_ZERO"


@functools.cache
def _names(casadi: typing.Any) -> dict[int, str]:
    return {getattr(casadi, name): name for name in [*_OPERATIONS, *_LOGICAL, _CHOICE]}


def _of_instructions(casadi: typing.Any, value: typing.Any) -> Expression:
    """What the operations make, one after the other: sums of many terms are no nest of as many calls."""
    symbols = casadi.symvar(value)
    program = casadi.Function("f", symbols, [value])
    made: dict[int, Expression] = {}
    for k in range(program.n_instructions()):
        kind, inputs, outputs = program.instruction_id(k), program.instruction_input(k), program.instruction_output(k)
        if kind == casadi.OP_OUTPUT:
            return made.get(inputs[0], expression(0))
        if kind == casadi.OP_CONST:
            constant = program.instruction_constant(k)
            whole = abs(constant) < 1e15 and constant == int(constant)
            made[outputs[0]] = expression(int(constant) if whole else constant)
        elif kind == casadi.OP_INPUT:
            made[outputs[0]] = Expression(str(symbols[inputs[0]].name()))
        else:
            made[outputs[0]] = _operation(value, _names(casadi).get(kind), [made[i] for i in inputs])
    return expression(0)  # an SX that has no entry but structural zeros


def _operation(value: typing.Any, name: str | None, operands: list[Expression]) -> Expression:
    if name is None:
        raise refuse(f"{str(value)[:60]} has an operation that models do not", "write it with the functions of saltus")
    if name == _CHOICE:
        return if_(operands[0], operands[1], 0)
    if name in _LOGICAL:
        return _LOGICAL[name](*operands)
    made: Expression = _OPERATIONS[name](*(_number(operand) for operand in operands))
    return made


def _number(made: Expression) -> Expression:
    """A condition that is computed with is 1 or 0."""
    return if_(made, 1, 0) if made.is_condition else number(made)


reads("casadi", of_casadi)

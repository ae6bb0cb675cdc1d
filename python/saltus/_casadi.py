"""Expressions of CasADi as expressions of models."""

from __future__ import annotations

import typing

from ._expression import SUM, Expression, expression, refuse


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

    text, is_condition = _text(_operations(casadi), value)
    return Expression(text, SUM if not is_condition else 0, is_condition)


#: Operations of CasADi by their names, in the language of models.
_NUMBERS = {
    "OP_ADD": "({}+{})", "OP_SUB": "({}-{})", "OP_MUL": "({}*{})", "OP_DIV": "({}/{})", "OP_NEG": "(-{})",
    "OP_INV": "(1/{})", "OP_SQ": "({})^2", "OP_TWICE": "(2*{})", "OP_POW": "({})^({})", "OP_CONSTPOW": "({})^({})",
    "OP_EXP": "exp({})", "OP_LOG": "log({})", "OP_SQRT": "sqrt({})", "OP_SIN": "sin({})", "OP_COS": "cos({})",
    "OP_TAN": "tan({})", "OP_ASIN": "asin({})", "OP_ACOS": "acos({})", "OP_ATAN": "atan({})", "OP_SINH": "sinh({})",
    "OP_COSH": "cosh({})", "OP_TANH": "tanh({})", "OP_ATAN2": "atan2({},{})", "OP_HYPOT": "hypot({},{})",
    "OP_FABS": "abs({})", "OP_SIGN": "sign({})", "OP_FMIN": "min({},{})", "OP_FMAX": "max({},{})",
    "OP_FLOOR": "floor({})", "OP_CEIL": "(-floor(-({})))",
}  # fmt: skip
_COMPARISONS = {"OP_LT": "({}<{})", "OP_LE": "({}<={})", "OP_EQ": "({}=={})", "OP_NE": "({}!={})"}
_LOGICAL = {"OP_NOT": "(not {})", "OP_AND": "({} and {})", "OP_OR": "({} or {})"}
_CHOICE = "OP_IF_ELSE_ZERO"

Operations = dict[int, str]


def _operations(casadi: typing.Any) -> Operations:
    return {getattr(casadi, name): name for name in [*_NUMBERS, *_COMPARISONS, *_LOGICAL, _CHOICE]}


def _text(operations: Operations, value: typing.Any) -> tuple[str, bool]:
    """The expression, and whether it is a condition."""
    if value.is_symbolic():
        return str(value.name()), False
    if value.is_constant():
        return expression(float(value)).text, False
    name = operations.get(value.op())
    if name is None:
        raise refuse(f"{value} has an operation that models do not", "write it with the functions of saltus")
    operands = [_text(operations, value.dep(k)) for k in range(value.n_dep())]
    if name == _CHOICE:
        return f"if({_condition(*operands[0])},{_number(*operands[1])},0)", False
    if name in _LOGICAL:
        return _LOGICAL[name].format(*(_condition(*operand) for operand in operands)), True
    form = _NUMBERS.get(name) or _COMPARISONS[name]
    return form.format(*(_number(*operand) for operand in operands)), name in _COMPARISONS


def _number(text: str, is_condition: bool) -> str:
    return f"if({text},1,0)" if is_condition else text


def _condition(text: str, is_condition: bool) -> str:
    if not is_condition:
        raise refuse(f"{text} is no condition", "compare it: x > 0")
    return text

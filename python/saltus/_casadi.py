"""Expressions of CasADi as expressions of models."""

from __future__ import annotations

import typing

from ._expression import SUM, Expression, expression, refuse


def of_casadi(value: typing.Any) -> Expression:
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

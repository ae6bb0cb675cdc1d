"""Expressions of the language of model files, made with the operators of Python.

An expression is its text, with the parentheses that are needed: what is built from it is what the same text in a file is.
"""

from __future__ import annotations

import functools
import itertools
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

    __slots__ = ("text", "level", "is_condition", "owner", "height", "reach", "depth", "parts", "_part")
    __array_priority__ = 1000
    #: SymPy leaves its operators to who has a higher one.
    _op_priority = 1e6

    def __init__(self, text: str, level: int = PRIMARY, is_condition: bool = False, owner: Owner = None) -> None:
        self.text = text
        self.level = level
        self.is_condition = is_condition
        self.owner = owner
        #: Nodes on the longest way down, in this text and with its parts; what nests; expressions named in the text.
        self.height, self.reach, self.depth = 1, 1, 0
        self.parts: dict[str, Expression] = {}
        self._part: Expression | None = None

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

    def __xor__(self, other: Operand) -> typing.NoReturn:
        raise refuse(f"{self.text} ^ {other}: that is no power in Python", "write x**2; exactly one of two conditions: (a & ~b) | (~a & b)")

    __rxor__ = __xor__

    def __mod__(self, other: Operand) -> typing.Any:
        return call("mod", self, other)

    def __rmod__(self, other: Operand) -> typing.Any:
        return call("mod", other, self)

    def __floordiv__(self, other: Operand) -> typing.Any:
        return call("floor", self / other)

    def __rfloordiv__(self, other: Operand) -> typing.Any:
        return call("floor", other / self)

    def __neg__(self) -> Expression:
        return _signed("-", self)

    def __pos__(self) -> Expression:
        return _signed("+", self)

    def __abs__(self) -> typing.Any:
        return call("abs", self)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: typing.Any, **how: typing.Any) -> typing.Any:
        one = [_one(value).view(_array.Array) if isinstance(value, Expression) else value for value in inputs]
        return getattr(ufunc, method)(*one, **how)

    def __array_function__(self, func: typing.Any, types: typing.Any, args: typing.Any, kwargs: typing.Any) -> typing.Any:
        """What numpy does with an expression it does with an array that has no axis: np.where(x > 0, 1, 2)."""
        found = func(*map(_as_arrays, args), **{name: _as_arrays(value) for name, value in kwargs.items()})
        return found[()] if isinstance(found, np.ndarray) and found.ndim == 0 else found

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
        return make("not " + _inside(self, NOT), NOT, True, 1 + _depth(self, NOT), self)

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

    __trunc__ = __float__

    def __round__(self, digits: int = 0) -> typing.NoReturn:
        raise refuse(f"{self.text} has no value before the simulation", "write saltus.floor(x + 0.5), of times only")

    __floor__ = __ceil__ = __round__

    def __iter__(self) -> typing.Iterator[Expression]:
        raise refuse(f"{self.text} is one number", "arrays of expressions: saltus.array([x, v])")


#: What makes expressions of the objects of another package, by its name.
_READERS: dict[str, typing.Callable[[typing.Any], Expression]] = {}


def reads(package: str, reader: typing.Callable[[typing.Any], Expression]) -> None:
    """Says how objects of a package become expressions."""
    _READERS[package] = reader


def _package_of(value: typing.Any) -> str:
    module = type(value).__module__ or type(value).__base__.__module__  # functions x(t) of SymPy have none of their own
    return module.partition(".")[0]


def is_foreign(value: typing.Any) -> bool:
    """Whether a value is an expression, or a matrix of some, of another package."""
    return _package_of(value) in _READERS


def expression(value: Operand) -> Expression:
    """A number as an expression."""
    if isinstance(value, Expression):
        return value
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return expression(value.item())
    reader = _READERS.get(_package_of(value))
    if reader is not None:
        return reader(value)
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise refuse(f"expected a number or an expression, found {value!r}", _instead_of(value))
    if not isinstance(value, numbers.Integral) and not math.isfinite(value):
        raise refuse(f"{float(value)} is no number of a model", "write a finite number")
    text = number_text(int(value) if isinstance(value, numbers.Integral) else float(value))
    return Expression(text, SIGN if text.startswith("-") else PRIMARY)


def number_text(value: int | float) -> str:
    """A finite number as the language writes it."""
    text = repr(value)
    return text.replace("e-0", "e-").replace("e+", "e") if "e" in text else text


def _instead_of(value: typing.Any) -> str:
    """What to write for what is no expression."""
    if isinstance(value, str):
        return "expressions are written without quotes, of what was given for the names: x = m.state(\"x\", 0), then -saltus.sign(x)"
    if isinstance(value, (bool, np.bool_)):
        return "write 1 or 0; a condition of the model is a comparison: x > 0"
    if np.ndim(value) > 0:
        return 'expressions are scalar; of arrays: m.states("x", [1, 0]), m.rate(X, A @ X), or entry by entry'
    return "numbers are real: int, float, or a scalar of numpy"


def number(value: Operand) -> Expression:
    """An expression that is no condition."""
    made = expression(value)
    if made.is_condition:
        raise refuse(f"{made.text} is a condition, not a number", f"write saltus.if_({made.text}, 1, 0)")
    return _part_of(made) if made.height >= HIGHEST or made.depth >= DEEPEST or len(made.text) >= LONG else made


#: What is larger has a name of its own in the text of the model: of a sum so many terms, so many calls and parentheses
#: inside of each other (the language has 1000 and 200 of them), so many characters.
HIGHEST, DEEPEST, LONG = 1000, 190, 30_000
#: Parts included: what goes through all of it does so by recursion.
FARTHEST = 5000
_numbers = itertools.count(1)


def _part_of(whole: Expression) -> Expression:
    """A name for an expression; the builder that writes it down defines it, and chooses the name."""
    if whole._part is None:
        whole._part = Expression(f"§{next(_numbers)}§", owner=whole.owner)
        whole._part.parts, whole._part.reach = {whole._part.text: whole}, whole.reach
    return whole._part


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


#: No expression has more characters: parts that occur twice in each other double at every step.
LONGEST = 5_000_000


def _depth(operand: Expression, level: int) -> int:
    return operand.depth + (operand.level < level)


def make(text: str, level: int, is_condition: bool, depth: int, *operands: Expression) -> Expression:
    if len(text) > LONGEST:
        raise refuse(
            f"an expression of more than {LONGEST} characters, {text[:40]}…",
            'name what occurs in it again and again: part = m.define("part", …)',
        )
    made = Expression(text, level, is_condition, owner_of(*operands))
    made.height, made.depth = 1 + max(operand.height for operand in operands), depth
    made.reach = 1 + max(operand.reach for operand in operands)
    if made.reach > FARTHEST:
        raise refuse(
            f"a chain, or nest, of more than {FARTHEST} operations: {text[:40]}…",
            "add groups of its terms, each by itself, and then these: sum(sum(group) for group in groups)",
        )
    parts = [operand.parts for operand in operands if operand.parts]
    made.parts = parts[0] if len(parts) == 1 else {key: part for some in parts for key, part in some.items()}
    return made


Made = typing.TypeVar("Made", bound=typing.Callable[..., typing.Any])


def entry_by_entry(of_one: Made) -> Made:
    """Of operands among which are arrays: an array of what is made of their entries."""

    @functools.wraps(of_one)
    def made(*operands: Operand) -> typing.Any:
        if not any(isinstance(operand, np.ndarray) and operand.ndim > 0 for operand in operands):
            return of_one(*operands)
        entries = [operand if isinstance(operand, np.ndarray) else _one(operand) for operand in operands]
        return _array.own(np.frompyfunc(of_one, len(operands), 1)(*entries))

    return typing.cast(Made, made)


def _one(operand: Operand) -> np.ndarray[typing.Any, typing.Any]:
    """An operand as an array that has no axis."""
    entry = np.empty((), dtype=object)
    entry[()] = operand
    return entry


def _as_arrays(value: typing.Any) -> typing.Any:
    """The same with arrays that have no axis in place of expressions."""
    if isinstance(value, Expression):
        return _one(value).view(_array.Array)
    if isinstance(value, (list, tuple)) and any(isinstance(entry, Expression) for entry in value):
        return [_as_arrays(entry) for entry in value]
    return value


@entry_by_entry
def _binary(sign: str, left: Operand, right: Operand, level: int) -> Expression:
    a, b = number(left), number(right)
    depth = max(_depth(a, level), _depth(b, level + 1))
    return make(_inside(a, level) + sign + _inside(b, level + 1), level, False, depth, a, b)


def _signed(sign: str, operand: Expression) -> Expression:
    a = number(operand)
    return make(sign + _inside(a, SIGN), SIGN, False, 1 + _depth(a, SIGN), a)


@entry_by_entry
def _power(base: Operand, exponent: Operand) -> Expression:
    a, b = number(base), number(exponent)
    depth = max(_depth(a, PRIMARY), 1 + _depth(b, SIGN))
    return make(f"{_inside(a, PRIMARY)}^{_inside(b, SIGN)}", POWER, False, depth, a, b)


@entry_by_entry
def _comparison(sign: str, left: Operand, right: Operand) -> Expression:
    a, b = number(left), number(right)
    depth = max(_depth(a, SUM), _depth(b, SUM))
    return make(_inside(a, SUM) + sign + _inside(b, SUM), COMPARISON, True, depth, a, b)


def condition(value: Operand, message: str, remedy: str) -> Expression:
    """A condition, of CasADi too; else what is refused."""
    made = expression(value) if is_foreign(value) else value
    if isinstance(made, Expression) and made.is_condition:
        return made
    raise refuse(f"{message}, found {value!r}", remedy)


def _condition(value: Operand, sign: str) -> Expression:
    remedy = "Python's & and | bind tighter than comparisons: write (x > 0) & (y > 0)"
    return condition(value, f"{sign} joins conditions", remedy)


@entry_by_entry
def _logical(word: str, left: Operand, right: Operand, level: int) -> Expression:
    a, b = _condition(left, word.strip()), _condition(right, word.strip())
    depth = max(_depth(a, level), _depth(b, level + 1))
    return make(_inside(a, level) + word + _inside(b, level + 1), level, True, depth, a, b)


@entry_by_entry
def call(function: str, *arguments: Operand) -> typing.Any:
    """A function of the language; of arrays entry by entry."""
    made = [number(argument) for argument in arguments]
    return called(function, *made)


def called(function: str, *made: Expression) -> Expression:
    """A call with these arguments, of which one may be a condition."""
    depth = 1 + max(argument.depth for argument in made)
    return make(f"{function}({','.join(argument.text for argument in made)})", PRIMARY, False, depth, *made)

"""What a builder has stated so far: names, their owner, and the text of the model file."""

from __future__ import annotations

import contextlib
import itertools
import json
import re
import typing

import numpy as np

from ._array import entries_of, is_sparse
from ._expression import Expression, Operand, expression, is_foreign, number, owner_of, refuse

#: The name of a part of an expression until it is written down.
_PART = re.compile(r"§\d+§")
Rates = typing.Mapping[typing.Any, Operand]
Entries = dict[str, typing.Any]
#: Names that the language has already: words, and functions, which may name what no expression has.
WORDS = frozenset("t pi otherwise and or not".split())
FUNCTIONS = frozenset(
    "if step sign abs max min floor mod initial sin cos tan asin acos atan atan2 sinh cosh tanh exp log log10 sqrt hypot pow".split()
)


class Statement:
    """The tables of a model file, filled one after the other; what :class:`saltus.Builder` is made of."""

    def __init__(self, name: str, description: str = "", inclusion: str | None = None) -> None:
        self.name = name
        self._model = given({"name": name, "description": description or None, "inclusion": inclusion})
        self._taken: set[str] = set()
        self._parts: dict[str, Entries] = {
            part: {}
            for part in ("parameters", "states", "controls", "definitions", "switching", "dynamics", "outputs", "tables")
        }
        self._lists: dict[str, list[Entries]] = {
            part: [] for part in ("contacts", "hysteresis", "modes", "jumps", "events")
        }
        self._pieces: dict[str, Expression] = {}  # of expressions that are too large
        self._inputs: Entries = {}
        self._simulate: Entries = {}
        self._mechanics: Entries = {}
        self._time_freezing: Entries = {}
        self._optimize: Entries = {}

    def to_toml(self) -> str:
        """The model file that states the same.

        >>> m = saltus.Builder("decay")
        >>> x = m.state("x", 1)
        >>> m.rate(x, -2*x)
        >>> print(m.to_toml().strip())
        [model]
        name = "decay"
        <BLANKLINE>
        [states]
        x = 1
        <BLANKLINE>
        [dynamics]
        x = "-2*x"
        """
        parts: list[tuple[str, Entries]] = [("[model]", self._model)]
        parts += [
            (f"[{part}]", self._parts[part])
            for part in ("parameters", "states", "controls", "definitions", "switching", "dynamics")
        ]
        parts.append(("[mechanics]", self._mechanics))
        parts += [(f"[[{part}]]", entry) for part, entries in self._lists.items() for entry in entries]
        parts.append(("[outputs]", self._parts["outputs"]))
        parts += [(f"[tables.{name}]", table) for name, table in self._parts["tables"].items()]
        inputs = {"inputs": self._inputs} if self._inputs else {}
        parts += [
            ("[simulate]", {**self._simulate, **inputs}),
            ("[optimize]", self._optimize),
            ("[time_freezing]", self._time_freezing),
        ]
        return self._with_parts(parts)

    def _with_parts(self, tables: list[tuple[str, Entries]]) -> str:
        """The text, with a definition for every part of an expression that is too large for one."""
        lines = [(head, _lines(entries)) for head, entries in tables]
        wanted, found = _PART.findall("".join(text for _, text in lines)), set()
        while wanted:
            key = wanted.pop()
            if key not in found and key in self._pieces:
                found.add(key)
                wanted += _PART.findall(self._pieces[key].text)
        free = (name for i in itertools.count(1) if (name := f"part{i}") not in self._taken)
        # Older ones are in newer ones.
        names = dict(zip(sorted(found, key=lambda key: int(key[1:-1])), free))
        defined = _lines({names[key]: self._pieces[key] for key in names})
        named = [(head, defined + text if head == "[definitions]" else text) for head, text in lines]
        text = "\n".join(f"{head}\n{entries}" for head, entries in named if entries)
        return _PART.sub(lambda match: names.get(match[0], match[0]), text) if names else text

    @contextlib.contextmanager
    def _all_or_nothing(self) -> typing.Iterator[None]:
        """What fails in the middle leaves nothing, so that the corrected call may follow."""
        parts, taken = {part: dict(entries) for part, entries in self._parts.items()}, set(self._taken)
        try:
            yield
        except BaseException:
            self._parts, self._taken = parts, taken
            raise

    # Names and owners ----------------------------------------------------------------------------------------------

    def _named(self, name: str | None) -> str | None:
        """A name that may be used, of what others may be called like, too, and of what no expression has."""
        if name is not None:
            self._check_name(name, WORDS)
        return name

    def _check_name(self, name: str, reserved: typing.Container[str]) -> None:
        if not isinstance(name, str) or not name.isidentifier() or not name.isascii():
            raise refuse(f"{name!r} is no name", "letters, digits and _, with a letter first: \"x1\"")
        if name in reserved:
            raise refuse(f"'{name}' is a word of the language", f"choose another name, e.g. {name}_")

    def _take(
        self, name: str, taken: typing.Container[str] | None = None, reserved: typing.Container[str] = WORDS | FUNCTIONS
    ) -> None:
        self._check_name(name, reserved)
        if name in (self._taken if taken is None else taken):
            raise refuse(f"the name '{name}' is taken", "every name of a model is declared once")
        self._taken.add(name)

    def _declare(self, part: str, name: str, value: typing.Any) -> Expression:
        # An output may have the name of the definition that it records.
        self._take(name, self._parts["outputs"] if part == "outputs" else None)
        self._parts[part][name] = value
        return Expression(name, owner=self)

    def _own(self, value: Operand) -> Expression:
        made = expression(value)
        owner_of(Expression("", owner=self), made)
        self._note_parts(made)
        return made

    def _note_parts(self, made: Expression) -> None:
        new = [(key, part) for key, part in made.parts.items() if key not in self._pieces]
        while new:
            key, part = new.pop()
            self._pieces[key] = part
            new += [(key, part) for key, part in part.parts.items() if key not in self._pieces]

    def _own_or_none(self, value: Operand) -> Expression | None:
        return None if value is None else self._own(value)

    def _own_all(self, value: typing.Any) -> typing.Any:
        """The same of tables and lists; texts and truths stay as they are."""
        if isinstance(value, typing.Mapping):
            return {name: self._own_all(entry) for name, entry in value.items()}
        if isinstance(value, (list, tuple)):
            return [self._own_all(entry) for entry in value]
        entries = entries_of(value) if is_foreign(value) or is_sparse(value) else None
        if entries is not None and (len(entries) != 1 or isinstance(entries[0], list)):
            return self._own_all(entries)
        if is_foreign(value):
            return self._own(value)
        if hasattr(value, "tolist") and not isinstance(value, Expression):
            return self._own_all(value.tolist())
        return self._own(value) if isinstance(value, Expression) else value

    def _value(self, main: str, value: Operand, beside: Entries) -> typing.Any:
        """A value alone, or a table of it where something is given beside it."""
        own = self._own(value)
        more = given(beside)
        return {main: own, **{name: self._own_all(entry) for name, entry in more.items()}} if more else own

    def _name_in(self, part: str, name: typing.Any) -> str:
        """A declared name: as a text, or as its expression, of other packages, too."""
        text = name if isinstance(name, str) else self._own(name).text
        if text not in self._parts[part]:
            known = ", ".join(self._parts[part]) or "none"
            raise refuse(f"'{text}' is none of the {part} of this builder", f"known: {known}")
        return text

    def _state(self, state: typing.Any) -> str:
        return self._name_in("states", state)

    def _states(self, states: typing.Any) -> list[str]:
        return [self._state(state) for state in vector_of(states)]

    def _rates(self, rates: Rates) -> dict[str, Expression]:
        if not isinstance(rates, typing.Mapping):
            raise refuse(f"expected a dict by states, found {rates!r}", "e.g. {x: -1}")
        return {self._state(state): self._own(number(value)) for state, value in rates.items()}

    def __repr__(self) -> str:
        return f"<saltus.Builder {self.name!r}: {', '.join(self._parts['states'])}>"


def vector_of(value: typing.Any) -> list[typing.Any]:
    """The entries of a list, or of a row or a column of any package.

    >>> vector_of([[1, 2]])
    [1, 2]
    """
    found = entries_of(value)
    entries = [value] if found is None and is_foreign(value) else list(value if found is None else found)
    if len(entries) == 1 and isinstance(entries[0], (list, tuple, np.ndarray)):
        return list(entries[0])
    return entries


def given(entries: Entries) -> Entries:
    """Those that are not None."""
    return {name: value for name, value in entries.items() if value is not None}


def _lines(entries: typing.Mapping[str, typing.Any]) -> str:
    return "".join(f"{name} = {_toml(value)}\n" for name, value in entries.items())


def _key(name: typing.Any) -> str:
    """A key of a table; in quotes where it is no word, as the text of a switching function."""
    return str(name) if str(name).isidentifier() and str(name).isascii() else json.dumps(str(name), ensure_ascii=False)


#: An expression that is a number is written as one; a whole number up to those that TOML has.
_NUMBER = re.compile(r"-?(?:0|[1-9]\d{0,17}|(?:0|[1-9]\d*)(?:\.\d+(?:[eE][+-]?\d+)?|[eE][+-]?\d+))")


def _toml(value: typing.Any) -> str:
    if isinstance(value, Expression):
        is_number = _NUMBER.fullmatch(value.text) is not None
        return value.text if is_number else json.dumps(value.text, ensure_ascii=False)
    if isinstance(value, typing.Mapping):
        return "{ " + ", ".join(f"{_key(name)} = {_toml(entry)}" for name, entry in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(entry) for entry in value) + "]"
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    return json.dumps(str(value), ensure_ascii=False)

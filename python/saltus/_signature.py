"""Signatures that name every option, and what help says of them, from the table of options."""

from __future__ import annotations

import functools
import inspect
import keyword
import typing

from . import _core

Function = typing.TypeVar("Function", bound=typing.Callable[..., typing.Any])
Entry = dict[str, typing.Any]

_INPUTS = "values of controls: {\"u\": \"sin(t)\"}, {\"u\": (times, values)}, a DataFrame, an earlier result"
_TABLES = {
    "event": "Options of the method \"event\" in a dict; their names are keywords, too.",
    "fesd": "Options of the method \"fesd\" in a dict; their names are keywords, too.",
    "smoothed": "Options of the method \"smoothed\" in a dict; their names are keywords, too.",
    "timestepping": "Options of the method \"timestepping\" in a dict; their names are keywords, too.",
}


def with_options(command: str, more: typing.Iterable[str] = ()) -> typing.Callable[[Function], Function]:
    """Gives a function, whose last argument is ``**options``, the options of a command as keywords: for completion and
    help. `command` is "simulate", "sweep", "optimize" or "mpcc"; `more` are keywords of [optimize] for its problem."""

    def decorate(function: Function) -> Function:
        stated = inspect.signature(function)
        own = [one for one in stated.parameters.values() if one.kind is not inspect.Parameter.VAR_KEYWORD]
        rest = [one for one in stated.parameters.values() if one.kind is inspect.Parameter.VAR_KEYWORD]
        named = {one.name for one in own}
        options = {word: entry for word, entry in words_of(command).items() if word not in named}
        keywords = [
            inspect.Parameter(word, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind_of(entry))
            for word, entry in options.items()
        ]
        left = rest if command == "sweep" else []  # where names of the model are keywords, too
        function.__signature__ = stated.replace(parameters=[*own, *keywords, *left])  # type: ignore[attr-defined]
        listed = "\n".join(f"            {word}: {_told(entry)}" for word, entry in options.items())
        function.__doc__ = f"{function.__doc__}\n        Options; what is not given is that of the model file:\n\n{listed}\n        "
        return function

    return decorate


@functools.cache
def words_of(command: str) -> dict[str, Entry]:
    """Keywords of a command with what the table of options says of each."""
    tables = _core.option_tables()
    if command in ("simulate", "sweep"):
        words = _words(entry for entry in tables["simulate"] if not entry["key"].startswith("timestepping."))
        words["inputs"] = {"expects": "a dict", "default": "", "doc": _INPUTS[0].upper() + _INPUTS[1:] + ".", "kind": "dict"}
        for table, doc in _TABLES.items():
            words[table] = {"expects": "a dict", "default": "", "doc": doc, "kind": "dict"}
        return words
    if command == "optimize":
        return {**_words(tables["problem"]), **_words(tables["optimize"])}
    limit = {"expects": "a finite number > 0", "default": "", "doc": "Seconds, of all problems together.", "kind": "float"}
    return {**_words(tables["mpcc"]), "time_limit": limit}


def _words(entries: typing.Iterable[Entry]) -> dict[str, Entry]:
    words: dict[str, Entry] = {}
    for entry in entries:
        word = entry["key"].removesuffix(".*").rpartition(".")[2]
        entry = {**entry, "kind": "dict"} if entry["key"].endswith(".*") else entry
        words.setdefault(word + "_" if keyword.iskeyword(word) else word, entry)
    return words


def kind_of(entry: Entry) -> str:
    """A short annotation: "float | None"."""
    if "kind" in entry or "words" not in entry:
        return f"{entry.get('kind', 'Any')} | None"
    kinds = [repr(word) for word in entry["words"]] + [str(value) for value in entry["values"]]
    kinds += ["bool"] * entry["truth"] + {"whole": ["int"], "real": ["float"], "": []}[entry["number"]]
    kinds += {"": [], "the_same": ["list[int]"], "numbers": ["list[float]"], "names": ["str", "list[str]"]}[entry["list"]]
    return " | ".join([*kinds, "None"])


def _told(entry: Entry) -> str:
    standard = {"true": "True", "false": "False"}.get(entry["default"], entry["default"])
    return f"{entry['expects']}{f'; default {standard}' * bool(standard)}. {entry['doc']}"

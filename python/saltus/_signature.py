"""Signatures that name every option, and what help says of them, from the table of options."""

from __future__ import annotations

import functools
import inspect
import keyword
import typing

from . import _core

Function = typing.TypeVar("Function", bound=typing.Callable[..., typing.Any])
Entry = dict[str, typing.Any]

_INPUTS = "Values of controls: {\"u\": \"sin(t)\"}, {\"u\": (times, values)}, a DataFrame, an earlier result."
_TABLES = ("event", "fesd", "smoothed", "timestepping")


def with_options(command: str) -> typing.Callable[[Function], Function]:
    """Gives a function, whose last argument is ``**options``, the options of a command as keywords: for completion and
    help. `command` is "simulate", "sweep", "optimize" or "mpcc"."""

    def decorate(function: Function) -> Function:
        stated = inspect.signature(function)
        own = [one for one in stated.parameters.values() if one.kind is not inspect.Parameter.VAR_KEYWORD]
        rest = [one for one in stated.parameters.values() if one.kind is inspect.Parameter.VAR_KEYWORD]
        names = {one.name for one in own}
        options = {word: entry for word, entry in words_of(command).items() if word not in names}
        keywords = [
            inspect.Parameter(word, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind_of(entry))
            for word, entry in options.items()
        ]
        left = rest if command == "sweep" else []  # where names of the model are keywords, too
        function.__signature__ = stated.replace(parameters=[*own, *keywords, *left])  # type: ignore[attr-defined]
        listed = "\n".join(f"            {word}: {_told(entry)}" for word, entry in options.items())
        function.__doc__ = f"{function.__doc__}\n        Options; what is not given is that of the model file::\n\n{listed}\n        "
        return function

    return decorate


@functools.cache
def words_of(command: str) -> dict[str, Entry]:
    """Keywords of a command with what the table of options says of each."""
    tables = _core.option_tables()
    if command in ("simulate", "sweep"):
        words = named(entry for entry in tables["simulate"] if not entry["key"].startswith("timestepping."))
        words["inputs"] = _table(_INPUTS)
        for table in _TABLES:
            words[table] = _table(f"Options of the method \"{table}\" in a dict; their names are keywords, too.")
        return words
    if command == "optimize":
        problem = {**named(tables["problem"]), **named(tables["optimize"])}
        return {**problem, "mpcc": _table("Options of [optimize.mpcc] in a dict; their names are keywords, too.")}
    limit = {"expects": "a finite number > 0", "default": "", "doc": "Seconds, of all problems together.", "kind": "float"}
    return {**named(tables["mpcc"]), "time_limit": limit}


def _table(doc: str) -> Entry:
    return {"expects": "a dict", "default": "", "doc": doc, "kind": "dict"}


def named(entries: typing.Iterable[Entry]) -> dict[str, Entry]:
    """Options by the last word of their key, as Python can have it: `from` is `from_`. The first of a name has it."""
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

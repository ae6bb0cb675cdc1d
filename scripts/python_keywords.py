"""Writes python/saltus/_keywords.py: the options as keywords with their types, from the table of options of the source.

  PYTHONPATH=build/release/python python scripts/python_keywords.py > python/saltus/_keywords.py

A test of the package compares.
"""

from __future__ import annotations

from saltus import _core
from saltus._signature import named, words_of

HEAD = '''"""Options as keywords, with their types, for signatures, help and whoever checks types.

Generated from the table of options of the source by scripts/python_keywords.py; a test compares.
"""

from __future__ import annotations

import typing

import numpy as np
import numpy.typing as npt

Whole = typing.Union[int, np.integer[typing.Any]]
Real = typing.Union[float, np.floating[typing.Any], np.integer[typing.Any]]
Reals = typing.Union[typing.Sequence[float], npt.NDArray[typing.Any]]
Wholes = typing.Union[typing.Sequence[int], npt.NDArray[typing.Any]]
Names = typing.Union[str, typing.Sequence[str]]
Several = typing.Union[typing.Sequence[typing.Any], npt.NDArray[typing.Any]]
Stated = typing.Any  #: an expression or what has some: a text, a number, an Expression, a list or a dict of them
'''
SWEEP = '''class SweepCall(SweepOptions, total=False):
    """All keywords of a sweep but names of the model."""

    zip: bool
    sample: typing.Union[typing.Mapping[str, str], None]
    runs: typing.Union[int, None]
    seed: int
    keep: typing.Literal["final", "events", "trajectory"]
    jobs: typing.Union[int, None]
    yes: bool
    until: typing.Union[Real, Several, None]
    set: typing.Any
    progress: bool
    executor: typing.Any
'''
#: Tables of [simulate].
TABLES = ("output", "event", "smoothed", "fesd", "timestepping")
#: Keywords that the table of options does not have.
OTHERS = {"inputs": "typing.Mapping[typing.Any, typing.Any]", "mpcc": "typing.Mapping[str, typing.Any]", "time_limit": "Real"}


def kinds_of(option: dict) -> str:
    """What an option may be, as annotations with commas between them."""
    kinds = []
    if option["words"]:
        kinds.append("typing.Literal[" + ", ".join(f'"{word}"' for word in option["words"]) + "]")
    if option["values"]:
        kinds.append("typing.Literal[" + ", ".join(map(str, option["values"])) + "]")
    if option["truth"]:
        kinds.append("bool")
    kinds += {"whole": ["Whole"], "real": ["Real"], "": []}[option["number"]]
    kinds += {"the_same": ["Wholes"], "numbers": ["Reals"], "names": ["Names"], "": []}[option["list"]]
    return ", ".join(kinds)


def annotation(word: str, option: dict) -> str:
    """The type of a keyword; of those that state a problem of control all that has expressions."""
    if word == "output":
        return f"{kinds_of(option)}, OutputTable"
    if word in TABLES:
        return f"{word.capitalize()}Table"
    if option.get("key", "").endswith(".*"):
        return f"typing.Mapping[typing.Any, typing.Union[{kinds_of(option)}]]"
    return kinds_of(option) if "words" in option else OTHERS.get(word, "Stated")


def typed(words: dict[str, dict]) -> dict[str, str]:
    return {word: annotation(word, option) for word, option in words.items()}


def keys_of(table: str) -> dict[str, str]:
    """Keys of a table of [simulate]."""
    return typed(named(option for option in _core.option_tables()["simulate"] if option["key"].startswith(f"{table}.")))


def dictionary(name: str, words: dict[str, str], doc: str, base: str = "typing.TypedDict", several: bool = False) -> str:
    """A class whose entries are these keywords; with `several` of most a list of values, too."""
    lines = [f'class {name}({base}, total=False):\n    """{doc}"""\n\n']
    for word, kind in words.items():
        more = ", Several" if several and "Mapping" not in kind and "Table" not in kind else ""
        lines.append(f"    {word}: typing.Union[{kind}{more}, None]\n")
    return "".join(lines)


def page() -> str:
    """The whole module."""
    parts = [HEAD]
    for table in TABLES:
        parts.append(dictionary(f"{table.capitalize()}Table", keys_of(table), f"Keys of [simulate.{table}]."))
    words = typed(words_of("simulate"))
    del words["until"]  # which is named where it stands
    steps = words.pop("steps")  # a list there
    parts.append(dictionary("OrderOptions", words, "Keywords of a study of errors over steps."))
    parts.append(dictionary("SimulateOptions", {"steps": steps}, "Keywords of a simulation.", "OrderOptions"))
    words["steps"] = steps
    parts.append(dictionary("SweepOptions", words, "Keywords of many simulations: of most several values are swept.", several=True))
    parts.append(SWEEP)
    problem = typed(words_of("optimize"))
    del problem["start"]  # which is named where it stands
    parts.append(dictionary("OptimizeOptions", problem, "Keywords of an optimisation."))
    parts.append(dictionary("MpccOptions", typed(words_of("mpcc")), "Keywords of a foreign problem with complementarities."))
    return "\n\n".join(parts)


if __name__ == "__main__":
    print(page(), end="")

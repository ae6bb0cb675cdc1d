"""Writes python/saltus/_keywords.py: the options as keywords with their types, from the table of options of the source.

  PYTHONPATH=build/release/python python scripts/python_keywords.py > python/saltus/_keywords.py

A test of the package compares.
"""

from __future__ import annotations

import keyword

from saltus import _core

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
#: Tables of [simulate] in the order in which a keyword is looked for in them.
TABLES = ("output", "event", "smoothed", "fesd", "timestepping")


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


def spelt(word: str) -> str:
    """As Python can have it: `from` is `from_`."""
    return word + "_" if keyword.iskeyword(word) else word


def words_of_simulate() -> tuple[dict[str, str], dict[str, dict[str, str]]]:
    """Types by keyword, and those of the keys of every table."""
    options = {option["key"]: option for option in _core.option_tables()["simulate"]}
    words: dict[str, str] = {}
    tables: dict[str, dict[str, str]] = {table: {} for table in TABLES}
    for key, option in options.items():
        if not key.startswith("timestepping."):
            words.setdefault(*_one(key, option))
        table, _, rest = key.partition(".")
        if rest and table in tables:
            tables[table].update([_one(rest, option)])
    words["inputs"] = "typing.Mapping[typing.Any, typing.Any]"
    words["output"] = f"{kinds_of(options['output'])}, OutputTable"
    words.update({table: f"{table.capitalize()}Table" for table in TABLES if table != "output"})
    return words, tables


def _one(key: str, option: dict) -> tuple[str, str]:
    kind = kinds_of(option)
    if key.endswith(".*"):
        return key[:-2].rpartition(".")[2], f"typing.Mapping[typing.Any, typing.Union[{kind}]]"
    return spelt(key.rpartition(".")[2]), kind


def words_of_optimize() -> dict[str, str]:
    words = {option["key"]: "Stated" for option in _core.option_tables()["problem"]}
    for option in _core.option_tables()["optimize"]:
        words.setdefault(*_one(option["key"], option))
    words["mpcc"] = "typing.Mapping[str, typing.Any]"
    return {spelt(word): kind for word, kind in words.items() if word != "start"}


def dictionary(name: str, words: dict[str, str], doc: str, several: bool = False) -> str:
    """A class whose entries are these keywords; with `several` of most a list of values, too."""
    lines = [f'class {name}(typing.TypedDict, total=False):\n    """{doc}"""\n\n']
    for word, kind in words.items():
        more = ", Several" if several and "Mapping" not in kind and "Table" not in kind else ""
        lines.append(f"    {word}: typing.Union[{kind}{more}, None]\n")
    return "".join(lines)


def page() -> str:
    """The whole module."""
    words, tables = words_of_simulate()
    parts = [HEAD]
    for table, keys in tables.items():
        parts.append(dictionary(f"{table.capitalize()}Table", keys, f"Keys of [simulate.{table}]."))
    del words["until"]  # which is named where it stands
    parts.append(dictionary("SimulateOptions", words, "Keywords of a simulation."))
    order = {word: kind for word, kind in words.items() if word != "steps"}  # a list there
    parts.append(dictionary("OrderOptions", order, "Keywords of a study of errors over steps."))
    parts.append(dictionary("SweepOptions", words, "Keywords of many simulations: of most several values are swept.", True))
    parts.append(SWEEP)
    parts.append(dictionary("OptimizeOptions", words_of_optimize(), "Keywords of an optimisation."))
    mpcc = dict(_one(option["key"], option) for option in _core.option_tables()["mpcc"])
    mpcc["time_limit"] = "Real"
    parts.append(dictionary("MpccOptions", mpcc, "Keywords of a foreign problem with complementarities."))
    return "\n\n".join(parts)


if __name__ == "__main__":
    print(page(), end="")

"""Exceptions and warnings."""

from __future__ import annotations

import re
import typing

if typing.TYPE_CHECKING:
    from ._result import Result


#: What the tool calls by its options has other names here.
_SPELLINGS = [
    (re.compile(r"--set (?:simulate\.|optimize\.)?inputs\.([\w.]+)"), r'inputs={"\1": …}'),
    (re.compile(r"--set (?:simulate|optimize)\.(\w+)"), r"\1=…"),
    (re.compile(r"--set ([\w.]+)=([^\s:]*):1:\d+: "), r'set={"\1": \2}: '),
    (re.compile(r"in --set ([\w.]+)"), r'in set={"\1": …}'),
    (re.compile(r"--set ([\w.]+)=(\S+)"), r'set={"\1": \2}'),
    (re.compile(r"--sample (\w+)=(\w+\([^)]*\))"), r'sample={"\1": "\2"}'),
    (re.compile(r"--over (\w+)=\S+"), r"\1=[…]"),
    (re.compile(r"--(runs|seed|jobs) (\d+)"), r"\1=\2"),
    (re.compile(r"--(method|integrator|branch) (\w+)"), r'\1="\2"'),
    (re.compile(r"--steps ([\d,]+)"), r"steps=[\1]"),
    (re.compile(r"give --until T on the command line"), "give until=…"),
    (re.compile(r"--(zip|yes)\b"), r"\1=True"),
    (re.compile(r"--out \S+"), "r.save(…)"),
    (re.compile(r"`?saltus simulate`?"), "m.simulate()"),
    (re.compile(r"cannot be set on the command line"), "cannot be set like this"),
    (re.compile(r" on the command line"), ""),
    (re.compile(r"--(until|set|over|sample|runs|steps|schemes|start|branch|method|jobs|seed|keep)\b"), r"\1="),
]


def in_python(text: str) -> str:
    """A message of the tool in the words of Python.

    >>> in_python("give --until T on the command line, or --runs 1000 with --zip")
    'give until=…, or runs=1000 with zip=True'
    """
    for found, written in _SPELLINGS:
        text = found.sub(written, text)
    return text


class ModelError(ValueError):
    """Bad input: a model, a setting or an option that states nothing, with its place and a remedy.

    The text is that of the tool, with its options spelt as keywords. ``message`` says what was expected and found, ``remedy`` what to do, ``file``,
    ``line`` and ``column`` where (counted from 1; 0 or empty: unknown), ``code`` which kind of mistake it is.

    >>> import saltus
    >>> try:
    ...     saltus.Model.from_text('[model]\\nname = "m"\\n[states]\\nx = "1 +"\\n', "m.toml")
    ... except saltus.ModelError as error:
    ...     print(error.line, error.column)
    4 9
    """

    def __init__(
        self,
        text: str,
        message: str = "",
        remedy: str = "",
        file: str = "",
        line: int = 0,
        column: int = 0,
        code: str = "",
    ) -> None:
        text, message, remedy = in_python(text), in_python(message), in_python(remedy)
        file = "" if file.startswith("--set ") else file
        super().__init__(text, message, remedy, file, line, column, code)
        self.message = message or text
        self.remedy = remedy
        self.file = file
        self.line = line
        self.column = column
        self.code = code

    def __str__(self) -> str:
        return str(self.args[0])


class Stopped(RuntimeError):
    """Raised by :meth:`Result.require` for a run that stopped early; ``result`` has what was computed.

    >>> import saltus
    >>> try:
    ...     saltus.catalogue("stick-slip").simulate(until=5, max_steps=9).require()
    ... except saltus.Stopped as stopped:
    ...     print(stopped.result.status)
    iteration_limit
    """

    def __init__(self, text: str, result: Result | None = None) -> None:
        super().__init__(text, result)
        self.result = result

    def __str__(self) -> str:
        return str(self.args[0])


class ModelWarning(UserWarning):
    """What the tool prints as a warning: unused names, options without effect.

    >>> import saltus, warnings
    >>> with warnings.catch_warnings(record=True) as warned:
    ...     warnings.simplefilter("always")
    ...     r = saltus.catalogue("stick-slip").simulate(until=1, epsilon=0.1)
    >>> warned[0].category.__name__
    'ModelWarning'
    """

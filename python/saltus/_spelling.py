"""What the tool says, in the words of Python: its flags are keywords here, its commands are methods."""

from __future__ import annotations

import functools
import re

_SPELLINGS = [
    # What the tool names whole, for which Python has another form.
    (
        r"--over mu=0\.05:0\.3:100 \(100 values, both ends among them\) or --over k=1,2,4",
        "mu=np.linspace(0.05, 0.3, 100) or k=[1, 2, 4]",
    ),
    (r"--schemes radau_iia:2,gauss_legendre:3", 'schemes=[("radau_iia", 2), ("gauss_legendre", 3)]'),
    (r"give --until T on the command line", "give until=…"),
    (r"give --intervals N on the command line", "give control_intervals=20"),
    (r"cannot be set on the command line", "cannot be set like this"),
    (r"a value on the command line consists", "a value consists"),
    (r" on the command line", ""),
    # Settings and options.
    (r"--set (?:simulate|optimize)\.(?:\w+\.)*(\w+)=([\w.+-]+)", r"\1=\2"),
    (r"--set (?:simulate\.|optimize\.)?inputs\.([\w.]+)", r'inputs={"\1": …}'),
    (r"--set (?:simulate|optimize)\.(\w+)", r"\1=…"),
    (r"in --(set|over|sample) (\S+)", r'in \1={"\2": …}'),
    (r"--set ([\w.]+)=(\S+?)(:?)(?=\s|$)", r'set={"\1": \2}\3'),
    (r"--set ([\w.]+)", r'set={"\1": …}'),
    # Sweeps.
    (r"--sample ([\w.]+)=(.*?): (?=expected|unknown|the |\w+ has)", r'sample={"\1": "\2"}: '),
    (r"--sample ([\w.]+)=(\w+\([^)]*\))", r'sample={"\1": "\2"}'),
    (r"--over ([\w.]+)=(\S*): (?=expected|an empty|more)", r'over={"\1": "\2"}: '),
    (r"--over ([\w.]+)=\S+", r"\1=[…]"),
    (r"--(runs|seed|jobs) (\d+)", r"\1=\2"),
    (r"--branch (\w+)", r'branches="\1"'),
    (r"--(method|integrator|solver) (\w+)", r'\1="\2"'),
    (r"--steps ([\d,]+)", r"steps=[\1]"),
    (r"--(zip|yes)\b", r"\1=True"),
    (r"--out \S+", "r.save(…)"),
    (r"--report\b", "r.report(…)"),
    (r"--branch\b", "branches="),
    (r"(?<![\w)])--(until|set|over|sample|runs|steps|schemes|start|method|rtol|atol|jobs|seed|keep)\b", r"\1="),
    # Commands.
    (r"`?\bsaltus models\b`?", "saltus.models()"),
    (r"`?\bsaltus (simulate|optimize|sweep|check|compare|order)\b`?", r"m.\1()"),
]
_FLAGS = ("--set ", "--over ", "--sample ")


@functools.cache
def _patterns() -> list[tuple[re.Pattern[str], str]]:
    """Made at the first message, as that takes longer than most of an import."""
    return [(re.compile(found), written) for found, written in _SPELLINGS]


#: Options of two tables that are one keyword.
_TWICE = re.compile(r"'(\w+)'(?: or '\1')+")
#: Whole names are left where they are what is to be written: set={"simulate.rtol": …}.
_DOTTED = re.compile(r"(?<![\w.])(?<!\{\")(?:simulate|optimize)\.(?:(?:event|output|fesd|timestepping|smoothed|mpcc)\.)?(?=[a-z])")


def in_python(text: str) -> str:
    """A message of the tool in the words of Python.

    >>> in_python("give --until T on the command line, or --runs 1000 with --zip")
    'give until=…, or runs=1000 with zip=True'
    """
    for found, written in _patterns() if text else []:
        text = found.sub(written, text)
    return text


def keywords(text: str) -> str:
    """Options by the words that are keywords: without the tables in which a file has them.

    >>> keywords("unknown option simulate.fesd.stage, did you mean 'simulate.fesd.stages'?")
    "unknown option stage, did you mean 'stages'?"
    """
    return _TWICE.sub(r"'\1'", _DOTTED.sub("", text))


def is_option(file: str) -> bool:
    """Whether the place of a mistake is an option or a setting instead of a file."""
    return file.startswith(_FLAGS) or re.match(r"[\w.]+=", file) is not None


def at_option(text: str, file: str) -> str:
    """A message about a keyword: what was given, and what is wrong with it.

    >>> at_option("--set mu=1+:1:3: error: an operand is missing", "--set mu=1+")
    'set={"mu": "1+"}: an operand is missing'
    """
    rest = text[len(file) :] if text.startswith(file) else None
    if rest is None:
        return text
    rest = re.sub(r"^(?::\d+:\d+)?: error: ", ": ", rest)
    return _given(file) + rest


def _given(file: str) -> str:
    if not file.startswith(_FLAGS):
        return file
    flag, _, setting = file.removeprefix("--").partition(" ")
    name, equal, value = setting.partition("=")
    is_number = re.fullmatch(r"[-+]?[\d.]+(e[-+]?\d+)?", value) is not None
    shown = "…" if not equal else value if is_number else f'"{value}"'
    parts = name.split(".")
    if parts[0] in ("simulate", "optimize") and len(parts) > 1:
        inner = ".".join(parts[2:])
        return f'inputs={{"{inner}": {shown}}}' if parts[1] == "inputs" else f"{parts[-1]}={shown}"
    return f'{flag}={{"{name}": {shown}}}'

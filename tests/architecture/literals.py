"""Ratchet of numbers that stand inline in formulas and conditions, without a name that says what they are.

Counted are floating-point literals other than 0, 1, 2 and 0.5; small ones ("1e-9") apart, as they are thresholds more often than
not. A number that a declaration names, and nothing else, is none: `constexpr double few = 1e-3;`, `double rtol = 1e-6;`.
"""

import fnmatch
import re

from sources import code_of, cpp_files, module_of_file

NUMBER = re.compile(r"(?<![\w.])(\d[\d']*\.?\d*(?:[eE][+-]?\d+)?)")
CONSTANT = re.compile(r"\bconstexpr\s[^;(={]*[={\[][^;]*;")
NAMED = re.compile(r"(?<=[\w>] )(\w+ ?)(?:= ?|\{)-?[\d.'eE+-]+\}?(?=;)")
USUAL = {0.0, 0.5, 1.0, 2.0}


def without_lines(match):
    return "\n" * match.group().count("\n")


def numbers_inline(text):
    """(line number, literal) of the numbers of a code without comments that have no name."""
    text = NAMED.sub(r"\1", CONSTANT.sub(without_lines, text))
    for number, line in enumerate(text.splitlines(), 1):
        for literal in NUMBER.findall(line):
            if ("." in literal or "e" in literal.lower()) and float(literal.replace("'", "")) not in USUAL:
                yield number, literal


def find_numeric_literals(root, table):
    """(module, or module and "small"; place and literal). Files of coefficients are exempt, as from the limit of lines."""
    for path in cpp_files(root):
        name = str(path.relative_to(root))
        if any(fnmatch.fnmatch(name, pattern) for pattern in table["files"]["exempt"]):
            continue
        module = module_of_file(path, root)
        counts = {}
        for number, literal in numbers_inline(code_of(path)):
            # Equal literals of a line are two.
            counts[number, literal] = again = counts.get((number, literal), 0) + 1
            place = f"{name}:{number}: {literal}" + (f" (number {again})" if again > 1 else "")
            yield (f"{module}, small" if "e-" in literal.lower() else module), place

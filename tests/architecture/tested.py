"""Ratchet of the parts of engines that no unit test of their own module names.

A part is a header with its source, or a source alone. A test names it by including its header or by the name of a class that the
header declares; a source alone also by the class whose members it defines.
"""

import re

from sources import code_of, cpp_files

ENGINES = ("event_integrator/*", "fesd_integrator/*", "switching/*", "discretization/ocp")
DECLARED = re.compile(r"^(?:class|struct) (\w+)[^;()]*\{$", re.MULTILINE)
DEFINED = re.compile(r"^(?!\s)[^;=]*?\b([A-Z]\w*)::~?\w+\(", re.MULTILINE)


def is_part_of_engine(path, root):
    parts = path.relative_to(root / "src" / "saltus").parts[:-1]
    return any(
        len(parts) > 1 and parts[0] == place.split("/")[0] and place.split("/")[1] in ("*", parts[1]) for place in ENGINES
    )


def names_of_parts(root):
    """Path of a part without suffix -> (headers, names of classes)."""
    found = {}
    for path in cpp_files(root):
        if not is_part_of_engine(path, root):
            continue
        part = path.relative_to(root / "src").with_name(path.stem.removesuffix("_internal"))
        headers, classes = found.setdefault(str(part), (set(), set()))
        if path.suffix == ".hpp":
            headers.add(str(path.relative_to(root / "src")))
            classes.update(DECLARED.findall(code_of(path)))
    for part, (headers, classes) in found.items():
        if not headers:
            classes.update(DEFINED.findall(code_of(root / "src" / f"{part}.cpp")))
    return found


def find_untested_parts(root, _table):
    """(module, part)."""
    words = {}
    for part, (headers, classes) in sorted(names_of_parts(root).items()):
        module = part.split("/")[1]
        if module not in words:
            text = "\n".join(
                path.read_text(encoding="utf-8", errors="replace")
                for path in sorted((root / "tests" / "unit" / module).rglob("*"))
                if path.suffix in (".cpp", ".hpp")
            )
            words[module] = (set(re.findall(r"\w+", text)), set(re.findall(r'#include "([^"]+)"', text)))
        named, included = words[module]
        if not headers & included and not classes & named:
            yield module, f"src/{part}"

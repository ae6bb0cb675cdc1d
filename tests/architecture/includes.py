"""Ratchets of includes: what a source reaches through all that it includes, and headers from inside rooms of other modules."""

import re

from sources import cpp_files, lines_of

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
EIGEN = ("Eigen/", "unsupported/Eigen/")
FORCED_INCLUDE = re.compile(r"(?<!\S)-include\s+([^\s)]+)")


def module_of(name):
    """Module of an included name "saltus/…"; each folder of adapters is a module of its own."""
    parts = name.split("/")[1:]
    return "/".join(parts[:2]) if parts[0] == "adapters" else parts[0]


def included_names(root):
    """Name as it would be included -> names that the file includes, of every file of the modules."""
    return {
        str(path.relative_to(root / "src")): INCLUDE.findall(path.read_text(encoding="utf-8", errors="replace"))
        for path in cpp_files(root)
    }


def reaching(included, prefixes):
    """Files that include a name with one of the prefixes, or a file that does."""
    users = {}
    for file, names in included.items():
        for name in names:
            users.setdefault(name, []).append(file)
    waiting = [file for name, files in users.items() if name.startswith(prefixes) for file in files]
    reached = set()
    while waiting:
        file = waiting.pop()
        if file not in reached:
            reached.add(file)
            waiting += users.get(file, [])
    return reached


def sources_that_reach(root, prefixes, homes):
    """(module, source) of the sources outside of the homes of a package that reach it."""
    for file in sorted(reaching(included_names(root), prefixes)):
        module = module_of(file)
        if file.endswith(".cpp") and module not in homes and module.split("/")[0] not in homes:
            yield module, f"src/{file}"


def find_reaches_casadi(root, table):
    """Sources of modules that state nothing in CasADi's expressions."""
    rules = [rule for rule in table["third_party"] if rule["name"] == "CasADi"]
    homes = {module for rule in rules for module in rule["anywhere"] + rule["sources"]}
    return sources_that_reach(root, ("casadi/",), homes)


def find_reaches_eigen(root, _table):
    return sources_that_reach(root, EIGEN, {"linalg", "adapters"})


def find_forced_includes(root, _table):
    """Headers that the compiler is told to include first: a source depends on them, and does not say so."""
    for path in [root / "CMakeLists.txt", *sorted((root / "cmake").glob("*.cmake"))]:
        for number, line in enumerate(lines_of(path) if path.exists() else [], 1):
            match = FORCED_INCLUDE.search(line.partition("#")[0])
            if match:
                yield "build", f"{path.relative_to(root)}:{number}: {match.group(1)}"


def find_rooms_of_others(root, _table):
    """Headers in a folder of a module that another module includes. Headers at the root of a module are its face."""
    for file, names in included_names(root).items():
        for name in names:
            if not name.startswith("saltus/") or module_of(name) == module_of(file):
                continue
            depth = len(name.split("/")) - len(module_of(name).split("/"))
            if depth > 2:
                yield module_of(file), name

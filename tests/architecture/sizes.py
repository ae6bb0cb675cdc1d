"""Checks of sizes and rooms: files in a folder, lines of a function, data members of a class, includes between the rooms
of a module, headers that nobody outside a module uses.

The sources are formatted by clang-format, so what begins a scope is known from its line, and its end from the indent.
"""

import re

from sources import cpp_files, lines_of

INCLUDE = re.compile(r'^\s*#\s*include\s*"(saltus/[^"]+)"')
SCOPE_WORD = re.compile(r"^(namespace|class|struct|union|enum|extern|template|using|typedef|friend|static_assert)\b")
CLASS = re.compile(r"^(\s*)(?:template\s*<.*>\s*)?(class|struct)\s+(\w+)[^;=()]*\{$")
CONTROL_WORD = re.compile(r"^(if|for|while|switch|else|do|return|\}|:|,)\b|^[:,})]")
DATA_MEMBER = re.compile(r"^(?!using\b|friend\b|typedef\b|static\b|enum\b|struct\b|class\b|return\b|public\b|private\b)"
                         r"(?:mutable\s+)?[A-Za-z_][\w:<>,\s\*&\.\(\)]*?[\s\*&>]\w+(?:\[\w*\])?\s*(?:=[^;]*|\{[^;]*\})?(?:,\s*\w+[^;()]*)?;")


def check_files_in_folder(root, table):
    """(g) no folder holds more files than a person reads at a glance; folders of data are named in the table."""
    limit, exempt = table["sizes"]["files_in_folder"], set(table["sizes"]["folders_of_data"])
    complaints = []
    for top in ("src", "tests", "benchmarks", "python", "docs", "examples", "scripts", "cmake", "models"):
        folders = [root / top, *sorted(path for path in (root / top).rglob("*") if path.is_dir())]
        for folder in folders:
            name = str(folder.relative_to(root))
            if not folder.exists() or name in exempt or "__pycache__" in name:
                continue
            count = sum(1 for path in folder.iterdir() if path.is_file())
            if count > limit:
                complaints.append(f"{name}:1: {count} files; make rooms (limit {limit})")
    return complaints


def indent_of(line):
    return len(line) - len(line.lstrip())


def functions(lines):
    """(line number, name, lines) of functions: a signature at the margin, or in a class, that ends with "{"."""
    index = 0
    while index < len(lines):
        start = index
        index += 1
        if not re.search(r"\)[^;{}]*\{$", lines[start]):
            continue
        last = start
        # A signature over several lines begins above.
        while start > 0 and lines[start].count("(") < lines[start].count(")") or indent_of(lines[start]) > 2:
            start -= 1
            if not lines[start].strip() or start == 0:
                break
        first = lines[start].strip()
        indent = indent_of(lines[start])
        if indent > 2 or "(" not in first or SCOPE_WORD.match(first) or CONTROL_WORD.match(first):
            continue
        end = next((k for k in range(last + 1, len(lines)) if lines[k].startswith(" " * indent + "}")), None)
        if end is None:
            continue
        name = re.search(r"([\w~:]+)\s*\(", first)
        yield start + 1, name.group(1) if name else "?", end - start + 1
        index = end + 1


def check_function_length(root, table):
    """(h) no function longer than a screen."""
    limit = table["sizes"]["function_lines"]
    return [
        f"{path.relative_to(root)}:{number}: {name} has {length} lines; split it (limit {limit})"
        for path in cpp_files(root)
        for number, name, length in functions(lines_of(path))
        if length > limit
    ]


BRANCH = re.compile(r"\b(?:if|for|while|case|catch)\b| && | \|\| | \? ")


def check_ways(root, table):
    """(m) no function with more ways through it than a person follows (cyclomatic complexity)."""
    limit = table["sizes"]["ways"]
    complaints = []
    for path in cpp_files(root):
        lines = [re.sub(r'"(?:[^"\\]|\\.)*"|//.*', "", line) for line in lines_of(path)]
        for number, name, length in functions(lines):
            ways = 1 + len(BRANCH.findall("\n".join(f" {line} " for line in lines[number - 1 : number - 1 + length])))
            if ways > limit:
                complaints.append(f"{path.relative_to(root)}:{number}: {name} has {ways} ways through it; split it "
                                  f"(limit {limit})")
    return complaints


def check_position(root, _table):
    """(n) a run goes on by Position::move_to and change_mode only: nothing else gives it another time, state or mode."""
    writes = re.compile(r"\bhere_\.(?:t|x|state) = |\bhere_\.x\.begin\(\)\)")
    return [
        f"{path.relative_to(root)}:{number}: the position of a run is written; use move_to() or change_mode()"
        for path in cpp_files(root)
        for number, line in enumerate(lines_of(path), 1)
        if writes.search(line)
    ]


def classes(lines):
    """(line number, name, number of data members) of the classes and structs that have member functions."""
    for number, line in enumerate(lines):
        match = CLASS.match(line)
        if not match:
            continue
        indent = len(match.group(1)) + 2
        members = calls = 0
        statement = ""
        for inner in lines[number + 1 :]:
            depth = len(inner) - len(inner.lstrip())
            if inner.strip() and depth < indent:
                if inner.strip().startswith(("public:", "private:", "protected:")):
                    continue
                break
            text = re.sub(r"//.*", "", inner).strip()
            if not text or depth > indent + (4 if statement else 0):
                continue
            statement = f"{statement} {text}".strip()
            if statement.endswith(("{", "}")) or statement.endswith(";"):
                if DATA_MEMBER.match(statement) and not re.search(r"\w\s*\([^)]*\)\s*(const)?\s*(noexcept)?\s*;", statement):
                    members += 1 + len(re.findall(r",\s*\w+_?(?:\s*=[^,;]*)?(?=[,;])", re.sub(r"<[^;]*>", "", statement)))
                elif "(" in statement:
                    calls += 1
                statement = ""
        if match.group(2) == "class" or calls:
            yield number + 1, match.group(3), members


def check_data_members(root, table):
    """(i) no class that holds everything; plain data without functions may have as many members as it needs."""
    limit = table["sizes"]["data_members"]
    complaints = []
    for path in cpp_files(root):
        for number, name, members in classes(lines_of(path)):
            if members > limit:
                complaints.append(f"{path.relative_to(root)}:{number}: {name} has {members} data members; take it apart "
                                  f"(limit {limit})")
    return complaints


def check_rooms(root, table):
    """(j) a room includes only rooms that the table lists before it, and from the face of its module only plain types."""
    complaints = []
    for module, rules in table["rooms"].items():
        order = {room: place for place, room in enumerate(rules["order"])}
        for path in cpp_files(root):
            parts = path.relative_to(root / "src" / "saltus").parts
            if parts[0] != module:
                continue
            room = "/".join(parts[1:-1])
            if room not in order:
                complaints.append(f"{path.relative_to(root)}:1: room {room or '(the face)'} of {module} is not in the table")
                continue
            for number, line in enumerate(lines_of(path), 1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                target = match.group(1).split("/")[1:]
                if target[0] != module:
                    continue
                other = "/".join(target[1:-1])
                if other == room or (other == "" and target[-1] in rules["types"]):
                    continue
                if order.get(other, len(order)) >= order[room]:
                    complaints.append(f"{path.relative_to(root)}:{number}: {room or 'the face'} must not include {match.group(1)}")
    return complaints


def check_installed_headers(root, table):
    """(k) what is installed includes only what is installed: of a module with rooms the headers of its face."""
    declared = re.findall(r"^saltus_module\((\S+)[^)]*\bFACE\b", (root / "CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE)
    complaints = []
    for path in cpp_files(root):
        parts = path.relative_to(root / "src" / "saltus").parts
        hidden = path.suffix == ".cpp" or path.name.endswith("_internal.hpp") or (parts[0] in declared and len(parts) > 2)
        if hidden or parts[0] == "cli":
            continue
        for number, line in enumerate(lines_of(path), 1):
            match = INCLUDE.match(line)
            target = match.group(1).split("/")[1:] if match else []
            if len(target) > 2 and target[0] in declared:
                complaints.append(f"{path.relative_to(root)}:{number}: {match.group(1)} is not installed")
            elif target and target[-1].endswith("_internal.hpp"):
                complaints.append(f"{path.relative_to(root)}:{number}: {match.group(1)} is not installed")
    return complaints


SIZE_CHECKS = {
    "installed_headers": check_installed_headers,
    "files_in_folder": check_files_in_folder,
    "function_length": check_function_length,
    "ways": check_ways,
    "position": check_position,
    "data_members": check_data_members,
    "rooms": check_rooms,
}

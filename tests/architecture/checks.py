"""The checks of the architecture test, each a function of a source tree (a folder) and the table of dependencies.

Every check returns its complaints as lines "file:line: what is wrong"; an empty list means that all is well.
check_architecture.py runs them on the repository, self_test.py on trees that are wrong on purpose.
"""

import fnmatch
import re
from pathlib import Path

from prose import PROSE_CHECKS
from ratchets import RATCHET_CHECKS
from sizes import SIZE_CHECKS
from sources import lines_of

ALWAYS_ALLOWED = {"base", "linalg"}
SOURCE_SUFFIXES = {".cpp", ".hpp", ".h", ".py", ".sh", ".cmake", ".js", ".css"}
SKIPPED_FOLDERS = {".git", ".venv", "build", "demo", "__pycache__"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
FORBIDDEN_WORD = re.compile(r"\b(" + "|".join(("TO" + "DO", "FIX" + "ME", "XX" + "X", "HA" + "CK")) + r")\b")
CITATION = re.compile(r"\[([a-z]+(?:[a-z-]*[a-z])?(?:19|20)\d\d[a-z]?)\]")


def all_files(root):
    """Files of the tree that people write, in a fixed order."""
    for path in sorted(root.rglob("*")):
        parts = path.relative_to(root).parts
        skipped = any(part in SKIPPED_FOLDERS or part.startswith("build-") for part in parts)
        if not skipped and path.is_file():
            yield path


def source_files(root):
    return [path for path in all_files(root) if path.suffix in SOURCE_SUFFIXES or path.name == "CMakeLists.txt"]


def module_of(path, root):
    """Module of a C++ file below src/saltus, None for any other file."""
    parts = path.relative_to(root).parts
    inside = len(parts) > 3 and parts[:2] == ("src", "saltus") and path.suffix in (".cpp", ".hpp", ".h")
    return module_named(parts[2:]) if inside else None


def module_named(parts):
    """Module of a path below src/saltus; each folder of adapters is a module of its own."""
    return "/".join(parts[:2]) if parts[0] == "adapters" else parts[0]


def module_includes(root):
    """(path, line number, module, kind of brackets, included name) of every #include of the modules."""
    for path in all_files(root):
        module = module_of(path, root)
        if module is None:
            continue
        for number, line in enumerate(lines_of(path), 1):
            match = INCLUDE.match(line)
            if match:
                yield path, number, module, match.group(1), match.group(2)


def check_include_directions(root, table):
    """(a) #include "saltus/..." only as the table allows; only full paths; no private header of another module."""
    complaints = []
    for path, number, module, bracket, name in module_includes(root):
        place = f"{path.relative_to(root)}:{number}"
        if module not in table["modules"]:
            complaints.append(f"{place}: module {module} is not in the table of dependencies")
            continue
        if not name.startswith("saltus/"):
            # A header that the build generates has no folder in the tree, hence no full path.
            if bracket == '"' and (path.parent / name).exists():
                complaints.append(f'{place}: include "{name}" by its full path, "saltus/{module}/{name}"')
            continue
        target = module_named(name.split("/")[1:])
        allowed = set(table["modules"][module])
        if target != module and target not in ALWAYS_ALLOWED | allowed and "*" not in allowed:
            complaints.append(f"{place}: {module} must not include {target} ({name})")
        if target != module and name.endswith("_internal.hpp"):
            complaints.append(f"{place}: {name} is private to {target}")
    return complaints


def check_third_party(root, table):
    """(a) third-party headers only where the table allows them."""
    complaints = []
    for path, number, module, _, name in module_includes(root):
        is_source = path.suffix == ".cpp" or path.name.endswith("_internal.hpp")
        for rule in table["third_party"]:
            if not re.fullmatch(rule["header"], name):
                continue
            if module in rule["anywhere"] or (is_source and module in rule["sources"]):
                continue
            where = "its public headers" if module in rule["sources"] else module
            complaints.append(f"{path.relative_to(root)}:{number}: {rule['name']} ({name}) has no place in {where}")
    return complaints + check_facades(root, table)


def check_facades(root, table):
    """(a) what has `facade = true` is included by one file of a module: the others include that file."""
    files = {}
    for path, _, module, _, name in module_includes(root):
        for rule in table["third_party"]:
            if rule.get("facade") and re.fullmatch(rule["header"], name):
                files.setdefault((rule["name"], module), set()).add(str(path.relative_to(root)))
    return [f"{module}: {name} is included by {len(own)} files ({', '.join(sorted(own)[:3])}, ...): one header is enough"
            for (name, module), own in sorted(files.items()) if len(own) > 1]


def cmake_modules(text):
    """Module -> linked modules, from the saltus_module(...) calls of a CMakeLists.txt."""
    keywords = {"LINKS", "PUBLIC_LIBRARIES", "PRIVATE_LIBRARIES", "HEAVY_HEADERS", "FACE"}
    modules = {}
    for arguments in re.findall(r"^saltus_module\(([^)]*)\)", text, re.MULTILINE):
        words = re.sub(r"#.*", "", arguments).split()
        links, reading = set(), False
        for word in words[1:]:
            if word in keywords:
                reading = word == "LINKS"
            elif reading:
                links.add(word)
        modules[words[0]] = links
    return modules


def check_cmake_links(root, table):
    """(b) saltus_module(...) links exactly what the table allows, as far as those modules exist."""
    found = cmake_modules((root / "CMakeLists.txt").read_text(encoding="utf-8"))
    complaints = [] if found else ["CMakeLists.txt:1: no saltus_module(...) found"]
    for module, links in found.items():
        if module not in table["modules"]:
            complaints.append(f"CMakeLists.txt:1: module {module} is not in the table of dependencies")
            continue
        wanted = set(table["modules"][module]) & set(found)
        for extra in sorted(links - wanted - ALWAYS_ALLOWED):
            complaints.append(f"CMakeLists.txt:1: saltus_module({module}) links {extra}, which the table forbids")
        for absent in sorted(wanted - links):
            complaints.append(f"CMakeLists.txt:1: saltus_module({module}) does not link {absent}, which the table lists")
    for folder in sorted((root / "src" / "saltus").iterdir()):
        if any(folder.glob("*.hpp")) and folder.name not in found and folder.name != "cli":
            complaints.append(f"CMakeLists.txt:1: src/saltus/{folder.name} is not declared by saltus_module")
    return complaints


def check_file_length(root, table):
    """(c) no source beyond the hard limit."""
    limit, exempt = table["files"]["hard_limit_lines"], table["files"]["exempt"]
    complaints = []
    for path in source_files(root):
        name = str(path.relative_to(root))
        length = len(lines_of(path))
        if length > limit and not any(fnmatch.fnmatch(name, pattern) for pattern in exempt):
            complaints.append(f"{name}:{limit}: {length} lines; split it (hard limit {limit})")
    return complaints


def check_forbidden_words(root, _table):
    """(d) work that is left belongs into an issue, not into the source."""
    complaints = []
    for path in source_files(root):
        for number, line in enumerate(lines_of(path), 1):
            match = FORBIDDEN_WORD.search(line)
            if match:
                complaints.append(f"{path.relative_to(root)}:{number}: {match.group(1)}: open an issue instead")
    return complaints


def check_citations(root, _table):
    """(e) every [key2024] in a C++ comment is an entry of docs/references.bib."""
    bibliography = root / "docs" / "references.bib"
    if not bibliography.exists():
        return []
    keys = set(re.findall(r"@\w+\{\s*([^,\s]+)\s*,", bibliography.read_text(encoding="utf-8")))
    complaints = []
    for path in source_files(root):
        if path.suffix not in (".cpp", ".hpp", ".h"):
            continue
        for number, line in enumerate(lines_of(path), 1):
            comment = line.partition("//")[2]
            for key in CITATION.findall(comment):
                if key not in keys:
                    complaints.append(f"{path.relative_to(root)}:{number}: [{key}] is not in docs/references.bib")
    return complaints


OPENS_UNNAMED = "namespace {"
CLOSES_UNNAMED = "}  // namespace"
TYPE = re.compile(r"(?:struct|class|enum class|enum|union)\s+(\w+)")
ALIAS = re.compile(r"(?:using|namespace)\s+(\w+)\s*=\s*(.*);")
VALUE_OR_FUNCTION = re.compile(r"(?!using\b|static_assert\b|concept\b)[^=({]*?(?<!::)\b(\w+)\s*[=({;\[]")


def unnamed_declarations(lines):
    """(line number, name, meaning) of what unnamed namespaces declare, formatted as clang-format does it: at the margin.
    The meaning of an alias is what it stands for, that of anything else None: two of them differ."""
    inside = in_text = False
    for number, line in enumerate(lines, 1):
        if in_text or 'R"(' in line:
            in_text = ')"' not in line
            continue
        if line in (OPENS_UNNAMED, CLOSES_UNNAMED):
            inside = line == OPENS_UNNAMED
            continue
        line = re.sub(r"^template\s*<.*>\s*(?=\w)", "", line)
        if not inside or not re.match(r"[A-Za-z_]", line) or line.startswith("template"):
            continue
        alias = ALIAS.match(line)
        match = alias or TYPE.match(line) or VALUE_OR_FUNCTION.match(line)
        if match and not match.group(1).isupper():  # TEST(...), and macros of ours
            yield number, match.group(1), alias.group(2) if alias else None


def check_names_of_sources(root, _table):
    """(f) sources of a folder may be compiled as one: none gives another thing a name of its unnamed namespace that one
    beside it has given already; neither functions with other arguments, which would take part in its calls."""
    complaints = []
    taken = {}
    for path in all_files(root):
        module = module_of(path, root)
        if module is None or path.suffix != ".cpp":
            continue
        for number, name, meaning in unnamed_declarations(lines_of(path)):
            first, its_meaning = taken.setdefault((module, name), (path, meaning))
            if first != path and (meaning is None or meaning != its_meaning):
                complaints.append(f"{path.relative_to(root)}:{number}: {name} is the name of another thing in {first.name}")
    return complaints


ALL_CHECKS = {
    "include_directions": check_include_directions,
    "third_party": check_third_party,
    "cmake_links": check_cmake_links,
    "file_length": check_file_length,
    "forbidden_words": check_forbidden_words,
    "citations": check_citations,
    "names_of_sources": check_names_of_sources,
    **SIZE_CHECKS,
    **PROSE_CHECKS,
    **RATCHET_CHECKS,
}

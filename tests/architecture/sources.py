"""How the checks read sources."""

import re

NO_CODE = re.compile(r'R"(?P<end>\w*)\(.*?\)(?P=end)"|"(?:\\.|[^"\\\n])*"|(?<!\w)\'(?:\\.|[^\'\\\n])+\'|//[^\n]*|/\*.*?\*/', re.DOTALL)


def lines_of(path):
    return path.read_text(encoding="utf-8", errors="replace").splitlines()


def cpp_files(root):
    return sorted(path for path in (root / "src" / "saltus").rglob("*") if path.suffix in (".cpp", ".hpp"))


def module_of_file(path, root):
    """Module of a file below src/saltus; each folder of adapters is a module of its own."""
    parts = path.relative_to(root / "src" / "saltus").parts
    return "/".join(parts[:2]) if parts[0] == "adapters" else parts[0]


def code_of(path):
    """The text of a source with as many lines, without comments and what stands in literals of text."""

    def emptied(match):
        text = match.group()
        return ('""' if text.endswith('"') else "") + "\n" * text.count("\n")

    return NO_CODE.sub(emptied, path.read_text(encoding="utf-8", errors="replace"))

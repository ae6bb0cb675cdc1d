"""Pages of docs/: blocks can be read, links are live, tables agree with those of the source. Nothing is simulated.

usage: check_docs.py ROOT TOOL
"""

import doctest
import re
import sys
from pathlib import Path

sys.dont_write_bytecode = True


def complaints_of_statuses(root):
    """Every status of the source has its row in docs/questions.md, and no other has."""
    source = (root / "src/saltus/result/status.cpp").read_text(encoding="utf-8")
    known = set(re.findall(r'"(\w+)"', source[source.index("terminations(") : source.index(");")]))
    page = (root / "docs/questions.md").read_text(encoding="utf-8")
    told = set(re.findall(r"^\| `(\w+)` \|", page, re.MULTILINE))
    return [f"docs/questions.md: status {name} is told or known, not both" for name in sorted(known ^ told)]


def complaints_of_questions(root):
    """At least ten questions of others, each with a link, a check of its answer and what it is compared with."""
    page = (root / "docs/asked-elsewhere.md").read_text(encoding="utf-8")
    sections = re.split(r"^## \d+\. ", page, flags=re.MULTILINE)[1:]
    complaints = [] if len(sections) >= 10 else [f"docs/asked-elsewhere.md: {len(sections)} questions"]
    for section in sections:
        title = section.partition("\n")[0]
        if "](https://" not in section or "ours(" not in section or "theirs(" not in section:
            complaints.append(f"docs/asked-elsewhere.md: '{title}' has no link, no answer, or nothing to compare it with")
    return complaints


def complaints_of_howtos(root, anchor_of):
    """Every row of the table in docs/howto.md has its how-to, under the same words."""
    page = (root / "docs/howto.md").read_text(encoding="utf-8")
    table = page.partition("## I want to")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| \[([^]]*)\]\(#([\w-]*)\) \|", table, re.MULTILINE)
    shown = {anchor_of(heading): heading for heading in re.findall(r"^### (.*)$", page, re.MULTILINE)}
    complaints = [] if len(rows) > 30 else [f"docs/howto.md: {len(rows)} rows with a link in the table 'I want to'"]
    for words, anchor in rows:
        if shown.get(anchor, "").lower() != words.lower():
            complaints.append(f"docs/howto.md: no how-to '### {words[0].upper()}{words[1:]}' at #{anchor}")
    return complaints


def complaints_of_index(root):
    """Every page is in a list of contents; every page in a list is there."""
    listed = set()
    for name in ("index", "reference"):
        for block in re.findall(r"```\{toctree\}\n(.*?)```", (root / f"docs/{name}.md").read_text(encoding="utf-8"), re.DOTALL):
            listed |= {line for line in block.splitlines() if re.fullmatch(r"[\w/-]+", line)}
    pages = {str(page.relative_to(root / "docs").with_suffix("")) for page in (root / "docs").rglob("*.md")}
    pages = {page for page in pages if not page.startswith("adr/")} - {"index"}
    made = {"gallery/index", "changes", "architecture"}
    return [f"docs: {page} is a page or listed, not both" for page in sorted(pages ^ (listed - made))]


def main(root, tool):
    sys.path.insert(0, str(root / "scripts/site"))
    import blocks
    import streams

    if doctest.testmod(streams).failed:
        sys.exit(1)
    complaints = complaints_of_statuses(root) + complaints_of_questions(root) + complaints_of_howtos(root, blocks.anchor_of) + complaints_of_index(root)
    if complaints:
        sys.exit("\n".join(complaints))
    blocks.run_pages(sorted((root / "docs").rglob("*.md")), tool, quick=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]).resolve())

"""CLAIMS.md: what README.md and docs/index.md claim is still said there, and what shows it is in the tree.

usage: check_claims.py ROOT

A section of CLAIMS.md is a page. A quotation in it is a sentence of that page; the lines behind it name files in backquotes, or a
test of a file as `path::Name`. Sentences with a word that promises (PROMISES) must be quoted.

A row of a table in README.md that compares ends with a link to its page of results: every number of the row stands on that page, and
benchmarks/all.py has a benchmark of that name.
"""

import re
import sys
from pathlib import Path

sys.dont_write_bytecode = True

PAGES = ("README.md", "docs/index.md")
PROMISES = re.compile(r"\b(every|never|always|exactly|whatever|any|each|minutes?|seconds?|digits|offline|certified|faster?|independent)\b|%", re.IGNORECASE)
END = re.compile(r"(?<=[.!?])\s+(?=[A-Z`*\[(])")
RESULTS = re.compile(r"^\| ([^|]*) \| (.*) \| \[(\w[\w-]*)\]\((benchmarks/results/[\w-]+\.md)\) \|$", re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.]*\d)")
FILE = re.compile(r"`((?:tests|benchmarks|scripts|python/tests|\.ci|\.github)/[\w./-]+)(?:::(\w+))?`")


def paragraphs(text):
    """Paragraphs and items of lists of a page, without code, headings and tables, in one line each."""
    text = re.sub(r"^---\n.*?\n---\n", "", text, count=1, flags=re.DOTALL)
    text = re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)
    for block in re.split(r"\n\s*\n|\n(?=- )", text):
        lines = [line for line in block.splitlines() if not line.startswith(("#", "|", "!["))]
        joined = re.sub(r"\s+", " ", " ".join(lines)).strip()
        if joined:
            yield joined.removeprefix("- ")


def sentences(text):
    return [sentence for paragraph in paragraphs(text) for sentence in END.split(paragraph)]


def claims(text):
    """(page, quoted sentence, text behind it) of CLAIMS.md."""
    for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        page, _, body = section.partition("\n")
        parts = re.split(r"((?:^> .*\n)+)", body, flags=re.MULTILINE)[1:]
        for quoted, behind in zip(parts[::2], parts[1::2]):
            yield page.strip(), re.sub(r"\s+", " ", re.sub(r"^> ", "", quoted, flags=re.MULTILINE)).strip(), behind


def complaints_of_files(root, quoted, behind):
    """What shows a claim is there."""
    named = FILE.findall(behind)
    if not named:
        yield f"CLAIMS.md: nothing shows '{quoted[:60]}'"
    for path, test in named:
        if not (root / path).exists():
            yield f"CLAIMS.md: there is no {path}"
        elif test and not re.search(rf"\b{test}\b", (root / path).read_text(encoding="utf-8")):
            yield f"CLAIMS.md: {path} has no {test}"


def complaints_of_figures(root):
    """Figures of README.md are those of the pages they name, which one command writes again."""
    rows = RESULTS.findall((root / "README.md").read_text(encoding="utf-8"))
    known = (root / "benchmarks/all.py").read_text(encoding="utf-8") if rows else ""
    for what, figures, name, page in rows:
        if f'"{name}"' not in known:
            yield f"README.md: benchmarks/all.py does not repeat '{name}' of the row '{what}'"
        if not (root / page).exists():
            yield f"README.md: there is no {page}"
            continue
        there = set(NUMBER.findall((root / page).read_text(encoding="utf-8")))
        yield from (f"README.md: {page} has no {figure}, which the row '{what}' says" for figure in NUMBER.findall(figures) if figure not in there)


def complaints(root):
    said = {page: sentences((root / page).read_text(encoding="utf-8")) for page in PAGES}
    found = list(claims((root / "CLAIMS.md").read_text(encoding="utf-8")))
    for page, quoted, behind in found:
        if quoted not in said.get(page, []):
            yield f"CLAIMS.md: {page} does not say '{quoted}'"
        yield from complaints_of_files(root, quoted, behind)
    yield from complaints_of_figures(root)
    for page, all_of_it in said.items():
        quotations = {quoted for of, quoted, _ in found if of == page}
        for sentence in all_of_it:
            if PROMISES.search(sentence) and sentence not in quotations:
                yield f"{page}: CLAIMS.md does not say what shows '{sentence}'"


def main(root):
    found = list(complaints(root))
    print("\n".join(found) if found else "every claim is said and shown")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))

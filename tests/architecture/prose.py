"""Checks of prose: how long the sentences of comments are, that they come to an end, and that pages name files that are there.

A comment has parts: paragraphs, items of a list ("- ", "1. "), fields ("@param x") and displayed lines. Displayed are
formulas, tables and examples, which stand farther to the right than the text around them. A sentence ends at a full
stop, colon, semicolon, exclamation or question mark before a space, and with its part. What stands in parentheses and
what has no letter is not counted.
"""

import re

from sources import lines_of

FULL_LINE = re.compile(r"^\s*(///<|///|//)(?: (.*))?$")
BEHIND_CODE = re.compile(r"^(.*?\S\s*)(///<|//) (.*)$")
LITERAL = re.compile(r"\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)'")
ITEM = re.compile(r"(?:- |\d+\. |@(?:param(?:\[\w+\])?|tparam) +[\w, .]*?(?:  +|$)|@\w+ *)")
PARENTHESES = re.compile(r"\([^()]*\)")
END_OF_SENTENCE = re.compile(r"(?<=[.:;!?])\s+")
ELLIPSIS = re.compile(r"\.\.\.|…")
# What may stand before and behind an ellipsis: "k_1, ..., k_m", "m = 1 ... n", "c0 + c1 r + ...", "t_0 < … < t_n".
BEFORE_ELLIPSIS = re.compile(r"(?:[+*<]\s*|(?:\S*[\d_^)\]]\S*|\b[A-Za-z]),?\s*)$")


def comments(lines):
    """(line number, whether it goes on with the comment of the line above, text) of the lines with comments."""
    in_text = False
    mark_above, column_above = "", -1
    for number, line in enumerate(lines, 1):
        if in_text or 'R"(' in line:
            in_text = ')"' not in line.partition('R"(')[2 if 'R"(' in line else 0]
            mark_above = ""
            continue
        if "//" not in line:
            mark_above = ""
            continue
        full = FULL_LINE.match(line)
        if full:
            mark, column, text = full.group(1), line.index("//"), full.group(2) or ""
            yield number, mark == mark_above and column == column_above, text
        else:
            behind = BEHIND_CODE.match(LITERAL.sub(lambda match: "_" * len(match.group()), line))
            if not behind:
                mark_above = ""
                continue
            mark, column = behind.group(2), len(behind.group(1))
            yield number, False, line[column + len(mark) + 1 :]
        mark_above, column_above = mark, column


def parts(lines):
    """(line number, text) of the parts of all comments."""
    start, text, is_item = 0, "", False
    for number, goes_on, line in comments(lines):
        item = ITEM.match(line.lstrip())
        is_displayed = line.startswith(" ") and not (is_item and goes_on)
        if not goes_on or item or is_displayed or not line.strip() or not text:
            if text:
                yield start, text
            start, text, is_item = number, "", bool(item)
            line = line.lstrip()[item.end() :] if item else line
        if is_displayed and not item:
            yield number, line.strip()
        else:
            text = f"{text} {line.strip()}".strip() or ("" if not item else " ")
    if text:
        yield start, text


def words_of_sentences(text):
    """(number of words, sentence) of the sentences of a part."""
    before = None
    while before != text:
        before, text = text, PARENTHESES.sub("", text)
    for sentence in END_OF_SENTENCE.split(text):
        yield sum(1 for word in sentence.split() if re.search("[A-Za-z]", word)), sentence


def check_comment_sentences(root, table):
    """(l) no sentence that a person has to read twice, and none that is left to the reader to end."""
    limit = table["sizes"]["words_in_sentence"]
    complaints = []
    for path in sorted(path for path in (root / "src" / "saltus").rglob("*") if path.suffix in (".cpp", ".hpp")):
        name = path.relative_to(root)
        for number, text in parts(lines_of(path)):
            for count, sentence in words_of_sentences(text):
                if count > limit:
                    complaints.append(f"{name}:{number}: {count} words (limit {limit}): {sentence[:60]}")
            for ellipsis in ELLIPSIS.finditer(text):
                before = text[: ellipsis.start()]
                if not BEFORE_ELLIPSIS.search(before):
                    complaints.append(f"{name}:{number}: an ellipsis outside of formulas: {before[-40:]}{ellipsis.group()}")
    return complaints


NAMED_FILE = re.compile(r"`((?:[\w-]+/)*[\w-]+\.(?:cpp|hpp|py|toml|sh|cmake)|(?:[\w-]+/)+[\w-]+)/?`")
NOT_OURS = re.compile(r"tl/|_internal\.hpp")


def check_named_files(root, _table):
    """(p) ARCHITECTURE.md and the READMEs of the modules name files and folders that are there, by the end of their path."""
    there = set()
    for top in ("src", "tests", "python", "docs", "scripts", "cmake", "benchmarks", "models"):
        for path in (root / top).rglob("*"):
            parts = path.relative_to(root).parts
            stem = path.stem.removesuffix("_internal")
            there.update("/".join((*parts[k:-1], name)) for k in range(len(parts)) for name in (path.name, path.stem, stem))
    complaints = []
    for page in [root / "ARCHITECTURE.md", *sorted((root / "src" / "saltus").rglob("README.md"))]:
        for number, line in enumerate(lines_of(page) if page.exists() else [], 1):
            for name in NAMED_FILE.findall(line):
                if name not in there and not NOT_OURS.match(name):
                    complaints.append(f"{page.relative_to(root)}:{number}: there is no {name}")
    return complaints


PROSE_CHECKS = {
    "comment_sentences": check_comment_sentences,
    "named_files": check_named_files,
}

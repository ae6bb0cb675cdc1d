"""Runs the blocks of pages: models are checked, commands and Python run, in a folder of their own for each page.

usage: blocks.py TOOL PAGE…        runs everything
       blocks.py --quick TOOL PAGE…   models are checked, Python is compiled, links of the pages are live; nothing is simulated

- ```toml with [model] is a model: it is checked, and saved under the name in `Save it as `name`` above it, or model.toml.
- ```toml without [model] is a part of one: it is read as TOML.
- ```python is run, one block after the other. {code-cell} runs when the site is built.
- a line `saltus …` in a block without a language, or in ```console or ```sh, is run; exit code 0 or 3. `…` in it: shown only.
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

SAVED = re.compile(r"[Ss]ave it as `([^`]+)`")
HEADING = re.compile(r"^#+\s+(.*)$", re.MULTILINE)


def blocks_of(text):
    """(language, content, text before it, line) of every fenced block."""
    found, begin, before = [], None, []
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            if begin is None:
                begin = (line[3:].strip(), [], "\n".join(before), number)
            else:
                found.append((begin[0], "\n".join(begin[1]), begin[2], begin[3]))
                begin = None
        elif begin is not None:
            begin[1].append(line)
        else:
            before.append(line)
    return found


def anchor_of(heading):
    text = re.sub(r"[`*\[\]]|\([^)]*\)(?=$)", "", heading.lower()) if "](" in heading else heading.lower().replace("`", "")
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def dead_links(page, text):
    complaints = []
    prose = re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    for target, anchor in re.findall(r"\]\(([^)\s#]*)(?:#([^)\s]*))?\)", prose):
        if re.match(r"[a-z]+:", target):
            continue
        file = page.parent / target if target else page
        if target.startswith(("gallery", "made", "../gallery", "../made")) or target in ("architecture.md", "changes.md"):
            continue  # pages that the site makes; built.py follows them
        if not file.exists():
            complaints.append(f"{page}: link to {target}, which is not there")
        elif anchor and file.suffix == ".md":
            known = {anchor_of(heading) for heading in HEADING.findall(file.read_text(encoding="utf-8"))}
            known |= set(re.findall(r"^\(([\w-]+)\)=$", file.read_text(encoding="utf-8"), re.MULTILINE))
            if anchor not in known:
                complaints.append(f"{page}: link to {target}#{anchor}: no such heading")
    return complaints


class Page:
    """The blocks of one page, run in one folder."""

    def __init__(self, path, tool, quick, folder):
        self.path, self.tool, self.quick, self.folder = path, tool, quick, Path(folder)
        self.names, self.ran = {"__name__": "page"}, 0

    def fail(self, line, message):
        sys.exit(f"{self.path}:{line}: {message}")

    def saltus(self, words, line, allowed=(0, 3)):
        done = subprocess.run([self.tool, *words], cwd=self.folder, capture_output=True, text=True, check=False)
        if done.returncode not in allowed:
            self.fail(line, f"saltus {shlex.join(words)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        self.ran += 1

    def model(self, content, before, line):
        try:
            known = tomllib.loads(content)
        except tomllib.TOMLDecodeError as error:
            self.fail(line, f"not TOML: {error}")
        if "model" not in known or not {"dynamics", "modes", "mechanics"} & set(known):
            return
        name = (SAVED.findall(before[-600:]) or SAVED.findall(content) or ["model.toml"])[-1]
        (self.folder / name).write_text(content, encoding="utf-8")
        self.saltus(["check", name], line)

    def python(self, content, line):
        code = compile(content, f"{self.path}:{line}", "exec")
        if self.quick:
            return
        try:
            exec(code, self.names)  # noqa: S102: the pages are ours
        except Exception as error:  # noqa: BLE001: any is a fault of the page
            self.fail(line, f"{type(error).__name__}: {error}")
        self.ran += 1

    def commands(self, content, line):
        for command in content.splitlines():
            command = command.split(" #")[0].strip().removeprefix("$ ")
            if command.startswith("saltus ") and not any(mark in command for mark in "…|>") and not self.quick:
                words = shlex.split(command)[1:]
                if all(word != word.upper() or not word.isalpha() for word in words):
                    self.saltus(words, line)

    def run(self):
        text = self.path.read_text(encoding="utf-8")
        complaints = dead_links(self.path, text)
        if complaints:
            sys.exit("\n".join(complaints))
        for language, content, before, line in blocks_of(text):
            if language == "toml":
                self.model(content, before, line)
            elif language == "python":
                self.python(content, line)
            elif language in ("", "console", "sh"):
                self.commands(content, line)
            elif language.startswith("{code-cell}"):
                cell = "\n".join(row for row in content.splitlines() if not row.startswith(":"))
                if not cell.lstrip().startswith(("%", "!")):
                    compile(cell, f"{self.path}:{line}", "exec")


def run_pages(pages, tool, quick=False):
    total, here = 0, os.getcwd()
    for path in pages:
        path = Path(path).resolve()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            page = Page(path, str(Path(tool).resolve() if os.sep in str(tool) else tool), quick, folder)
            page.run()
            os.chdir(here)
            total += page.ran
    print(f"{len(pages)} pages, {total} blocks and commands ran")


if __name__ == "__main__":
    arguments = sys.argv[1:]
    is_quick = arguments[:1] == ["--quick"]
    arguments = arguments[is_quick:]
    run_pages(arguments[1:], Path(arguments[0]).resolve(), is_quick)

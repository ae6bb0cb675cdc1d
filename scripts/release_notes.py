"""Prints the section of a version in CHANGELOG.md: the text of its release. Fails where tag, version and changelog do not agree.

usage: release_notes.py vX.Y.Z
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def notes(changelog, version):
    """Section of a version, without its heading, or None."""
    sections = re.split(r"^## ", changelog, flags=re.MULTILINE)[1:]
    found = [section.partition("\n")[2].strip() for section in sections if re.match(rf"{re.escape(version)}\b(?!\.)", section)]
    return found[0] if found else None


def main(tag):
    version = re.search(r'version = "([^"]+)"', (ROOT / "src/saltus/base/version.hpp").read_text(encoding="utf-8")).group(1)
    if tag != f"v{version}":
        sys.exit(f"the tag is {tag}, src/saltus/base/version.hpp says {version}: it must be v{version}")
    text = notes((ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), version)
    if not text:
        sys.exit(f"CHANGELOG.md has no section '## {version}': rename 'Unreleased'")
    print(text)


if __name__ == "__main__":
    main(sys.argv[1])

"""Writes the addresses of a release into the source before its wheels are built: [project.urls] of pyproject.toml, and where messages find pages.

usage: name_urls.py OWNER/REPOSITORY [ROOT]      in a workflow: name_urls.py "$GITHUB_REPOSITORY"

The documentation is where .github/workflows/site.yml puts it: https://OWNER.github.io/REPOSITORY/. Safe to repeat.
"""

import re
import sys
from pathlib import Path


def urls(owner, name):
    source = f"https://github.com/{owner}/{name}"
    return {"Documentation": f"https://{owner.lower()}.github.io/{name}/", "Source": source, "Issues": f"{source}/issues",
            "Changelog": f"{source}/blob/main/CHANGELOG.md"}


def with_urls(text, addresses):
    """pyproject.toml with these [project.urls] and no others."""
    text = re.sub(r"\[project\.urls\]\n(?:[^\[\n].*\n)*\n", "", text)
    table = "[project.urls]\n" + "".join(f'{key} = "{value}"\n' for key, value in addresses.items())
    return text.replace("[project.scripts]\n", f"{table}\n[project.scripts]\n", 1)


def with_address(text, address):
    """The header with the address of the pages."""
    text, count = re.subn(r'(docs_address = )"[^"]*"', rf'\g<1>"{address}"', text)
    if count != 1:
        sys.exit("name_urls.py: expected one docs_address")
    return text


def main(repository, root):
    owner, _, name = repository.partition("/")
    if not owner or not name:
        sys.exit(f"name_urls.py: expected OWNER/REPOSITORY, found '{repository}'")
    addresses = urls(owner, name)
    for file, change in ((root / "pyproject.toml", lambda text: with_urls(text, addresses)),
                         (root / "src/saltus/base/docs_page.hpp", lambda text: with_address(text, addresses["Documentation"]))):
        file.write_text(change(file.read_text(encoding="utf-8")), encoding="utf-8")
    print(addresses["Documentation"])


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]) if len(sys.argv) > 2 else Path(__file__).resolve().parents[1])

"""What must hold of built pages: nothing is loaded from elsewhere, internal links are live, the search finds what people ask."""

import re
import sys
from pathlib import Path
from urllib.parse import unquote

LOADED = re.compile(r"""<(?:script|img|iframe|source|video|audio)\b[^>]*?\bsrc=["'](https?:)?//|<link\b(?![^>]*rel=["'](?:canonical|search|index|next|prev)["'])[^>]*?href=["'](?:https?:)?//|@import\s+(?:url\()?["']?(?:https?:)?//|url\(["']?(?:https?:)?//""")
LINK = re.compile(r"""<a\b[^>]*?href=["']([^"'#]*)(?:#([^"']*))?["']""")
WORDS = ["chatter", "stiction", "threshold", "backlash"]


def check(site):
    site = Path(site)
    complaints = []
    # The page that runs models is a program that has texts of links: what it asks for is seen in the browser (browser.py).
    files = [page for page in sorted(site.rglob("*.html")) if page != site / "try.html"]
    pages = {page: page.read_text(encoding="utf-8") for page in files}
    anchors = {page: set(re.findall(r"""\bid=["']([^"']+)["']""", text)) for page, text in pages.items()}
    for page, text in pages.items():
        shown = page.relative_to(site)
        if found := LOADED.search(text):
            complaints.append(f"{shown}: loads {found.group(0)}")
        if re.search(r"<pre(?![^>]*tabindex)[\s>]", text) or 'role="heading">' in text:
            complaints.append(f"{shown}: a block or heading that keys or readers do not reach")
        for target, anchor in LINK.findall(text):
            if re.match(r"[a-z]+:", target):
                continue
            file = (page.parent / unquote(target)).resolve() if target else page
            if file.is_dir():
                file = file / "index.html"
            if not file.exists():
                complaints.append(f"{shown}: link to {target}, which is not there")
            elif anchor and file in anchors and unquote(anchor) not in anchors[file]:
                complaints.append(f"{shown}: link to {target}#{anchor}: no such place")
    for style in site.rglob("*.css"):
        if found := re.search(r"@import[^;]*//|url\(['\"]?(https?:)?//", style.read_text(encoding="utf-8")):
            complaints.append(f"{style.relative_to(site)}: loads {found.group(0)}")
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    complaints += [f"the search does not know '{word}'" for word in WORDS if word not in index]
    if complaints:
        sys.exit("\n".join(complaints))
    print(f"{len(pages)} pages: nothing loaded from elsewhere, all internal links live")


if __name__ == "__main__":
    check(sys.argv[1])

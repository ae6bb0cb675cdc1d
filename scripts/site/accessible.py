"""Makes built pages accessible where Sphinx leaves gaps."""

import re
from pathlib import Path

def mend(site):
    """Headings of lists have a level, lists of pages a name, columns without a heading a plain cell, the search a heading;
    blocks and tables that scroll can be reached by keys."""
    for page in Path(site).rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        mended = text.replace('<p class="caption" role="heading">', '<p class="caption" role="heading" aria-level="2">')
        mended = mended.replace('<div class="table-wrapper', '<div tabindex="0" class="table-wrapper')
        mended = mended.replace('<aside class="sidebar-drawer">', '<aside class="sidebar-drawer" aria-label="All pages">')
        mended = mended.replace('<aside class="toc-drawer', '<aside aria-label="On this page" class="toc-drawer')
        mended = re.sub(r'<th class="head">(<p></p>)?</th>', '<td class="head"></td>', mended)
        mended = mended.replace('<div id="search-results"></div>', '<h1>Search</h1><div id="search-results"></div>')
        mended = re.sub(r"<pre(?![^>]*tabindex)(?=[\s>])", '<pre tabindex="0"', mended)
        if mended != text:
            page.write_text(mended, encoding="utf-8")

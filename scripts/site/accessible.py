"""Makes built pages accessible where Sphinx leaves gaps."""

import re
from pathlib import Path

def mend(site):
    """Headings of lists have a level; blocks and tables that scroll can be reached by keys."""
    for page in Path(site).rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        mended = text.replace('<p class="caption" role="heading">', '<p class="caption" role="heading" aria-level="2">')
        mended = mended.replace('<div class="table-wrapper', '<div tabindex="0" class="table-wrapper')
        mended = re.sub(r"<pre(?![^>]*tabindex)(?=[\s>])", '<pre tabindex="0"', mended)
        if mended != text:
            page.write_text(mended, encoding="utf-8")

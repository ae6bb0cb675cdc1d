"""Makes built pages accessible where Sphinx leaves gaps, and asks axe-core and a browser, where both are there.

usage: accessible.py SITE [AXE.js]
"""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

ASKED = ["index.html", "gallery/index.html", "asked-elsewhere.html", "start.html", "model-file.html", "made/python.html"]
SCRIPT = """<script>{axe}</script><script>addEventListener("load", () => setTimeout(() => axe.run(document, {{runOnly: ["wcag2a",
"wcag2aa"]}}).then((found) => {{ const told = document.createElement("pre"); told.id = "told"; told.textContent =
btoa(unescape(encodeURIComponent(JSON.stringify(found.violations.map((v) => [v.id, v.nodes[0].html])))));
document.body.replaceChildren(told); }}), 300))</script></body>"""


def mend(site):
    """Headings of lists have a level; blocks and tables that scroll can be reached by keys."""
    for page in Path(site).rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        mended = text.replace('<p class="caption" role="heading">', '<p class="caption" role="heading" aria-level="2">')
        mended = mended.replace('<div class="table-wrapper', '<div tabindex="0" class="table-wrapper')
        mended = re.sub(r"<pre(?![^>]*tabindex)(?=[\s>])", '<pre tabindex="0"', mended)
        if mended != text:
            page.write_text(mended, encoding="utf-8")


def ask(site, axe):
    """Violations of WCAG 2 A and AA on some pages, as axe-core tells them; None where it cannot be asked."""
    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None or not Path(axe).exists():
        return None
    import base64

    complaints = []
    for name in ASKED:
        page = Path(site) / name
        if not page.exists():
            continue
        copy = page.with_name("asked_" + page.name)
        copy.write_text(page.read_text(encoding="utf-8").replace("</body>", SCRIPT.format(axe=Path(axe).read_text(encoding="utf-8"))), encoding="utf-8")
        try:
            done = subprocess.run(
                [browser, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=20000", "--dump-dom", copy.resolve().as_uri()],
                capture_output=True, text=True, timeout=120, check=False,
            )
        finally:
            copy.unlink()
        told = re.search(r'<pre id="told">([^<]*)</pre>', done.stdout)
        if told is None:
            complaints.append(f"{name}: axe-core gave no answer")
            continue
        complaints += [f"{name}: {rule}: {where[:160]}" for rule, where in json.loads(base64.b64decode(told.group(1)))]
    return complaints


if __name__ == "__main__":
    mend(sys.argv[1])
    found = ask(sys.argv[1], sys.argv[2]) if len(sys.argv) > 2 else []
    print("not asked" if found is None else "\n".join(found) or "no violations")
    sys.exit(bool(found))

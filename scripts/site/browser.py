"""Opens built pages in headless Chromium: nothing is asked for outside of them, the search finds, axe-core has no complaint.

usage: browser.py SITE [AXE.js]
"""

import shutil
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import look_at_report  # noqa: E402

WORDS = ["chattering", "stiction", "threshold", "backlash"]
# Pages of every kind: axe-core takes seconds for each.
ASKED = ["index", "start", "concepts", "howto", "questions", "coming-from", "asked-elsewhere", "benchmarks", "optimal-control", "model-file",
         "tutorials/best-controls", "citation", "gallery/index", "gallery/stick-slip", "made/python", "made/keys", "made/measured/compare"]
# In the dark only colours differ.
RULES = {"light": '["wcag2a", "wcag2aa"]', "dark": '{type: "rule", values: ["color-contrast"]}'}
AXE_RUN = """window.told = undefined; axe.run(document, {runOnly: RULES, preload: false, resultTypes: ["violations"]}).then((found) => {
  window.told = found.violations.map((v) => v.id + ": " + v.nodes[0].html.slice(0, 160)); });"""


def opened(site):
    """Every page but long lists of names; of the gallery and the decisions one of each."""
    pages = [page for page in sorted(site.rglob("*.html")) if page.name not in ("genindex.html", "py-modindex.html", "search.html", "cpp.html")]
    rest = [page for page in pages if page.parent.name not in ("gallery", "adr")]
    return [*rest, *(page for page in (site / "gallery/index.html", site / "gallery/stick-slip.html") if page.exists()), *sorted(site.glob("adr/0001*.html"))]


def value_of(browser, expression, seconds):
    """The value of an expression as soon as it has one."""
    end = time.monotonic() + seconds
    while not (found := browser.value(expression)) and found != [] and time.monotonic() < end:
        time.sleep(0.05)
    return found


def show(browser, url, theme):
    """Loads a page where the last one was: pages in the background have slow clocks."""
    if browser.session is None:
        browser.open(url, 1200, 900, theme)
        return
    browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])
    browser.call("Page.navigate", url=url)
    while browser.value("document.readyState") != "complete":
        time.sleep(0.01)


def search(browser, site):
    """Words that the search of the site does not find, from a file, without a server."""
    missing = []
    for word in WORDS:
        show(browser, (site / "search.html").resolve().as_uri() + f"?q={word}", "light")
        if not value_of(browser, "document.querySelectorAll('ul.search li a').length", 20):
            missing.append(f"the search does not find '{word}'")
    return missing


def ask(site, axe):
    """Complaints; None where there is no browser. Without axe-core only requests and the search are looked at."""
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        return None
    site, complaints = Path(site), []
    rules = Path(axe).read_text(encoding="utf-8") if Path(axe).exists() else None
    browser = look_at_report.Browser(program)
    try:
        complaints += search(browser, site)
        for page in opened(site):
            name = str(page.relative_to(site).with_suffix(""))
            asked = rules is not None and name in ASKED
            for theme in ("light", "dark") if asked else ("light",):
                show(browser, page.resolve().as_uri(), theme)
                if asked:
                    browser.value(rules + ";" + AXE_RUN.replace("RULES", RULES[theme]))
                    told = value_of(browser, "window.told", 60)
                    told = ["axe-core gave no answer"] if told is None else told
                    complaints += [f"{name}, {theme}: {text}" for text in told]
            # What else a console says is of pages in files: the search may not fetch the texts below its hits, for example.
            complaints += [f"{name}: {text}" for text in browser.complaints if text.startswith("request:")]
            browser.complaints = []
    finally:
        browser.close()
    return complaints


if __name__ == "__main__":
    found = ask(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else "")
    print("no browser" if found is None else "\n".join(found) or "no complaints")
    sys.exit(bool(found))

"""Pages of every kind fit narrow screens and paper, follow the theme, and have no complaint of axe-core.

axe-core comes with `scripts/install.sh developer`; where it is not, all of this but its rules is looked at.
usage: accessible_pages_test.py TOOL SOURCE BROWSER
"""

import json
import sys
import time
import unittest

from browser_page import SOURCE, Page

AXE = SOURCE / ".venv/axe/axe.min.js"
RUN = """;window.told = undefined; axe.run(document, {preload: false, resultTypes: ["violations"]}).then((found) => {
  window.told = JSON.stringify(found.violations.map((v) => `${v.id}: ${v.nodes[0].html.slice(0, 160)}`)); });"""
VIEWS = ((1280, "light", ""), (1280, "dark", ""), (390, "light", ""), (390, "dark", ""), (1280, "light", "print"))
FESD = ("--method", "fesd", "--set", "simulate.fesd.sensitivities=true")
CASES = {
    "a result": ("simulate", "stick-slip"),
    "one that is not unique": ("simulate", "part-ways", "--branch", "all"),
    "sensitivities": ("simulate", "stick-slip", "--until", "5", *FESD),
    "bodies": ("simulate", "falling-rod"),
    "an optimum": ("optimize", str(SOURCE / "examples/optimize/block.toml")),
    "a comparison": ("compare", "stick-slip", "--until", "5"),
    "values at events": ("sweep", "stick-slip", "--until", "5", "--over", "belt=0.1:0.4:4", "--keep", "events", "--out", "s.csv"),
    "a map": ("sweep", "stick-slip", "--until", "5", "--over", "belt=0.1,0.2", "--over", "q=0,0.1", "--out", "s.csv"),
}
#: Right ends of what stands on paper: pictures, tables, cards.
ON_PAPER = ("Math.max(...[...document.querySelectorAll('main svg, main table, main .card, main .phase-plot')]"
            ".filter((one) => one.checkVisibility()).map((one) => one.getBoundingClientRect().right))")
#: 0 is black, 255 is white.
BRIGHTNESS = "getComputedStyle(document.body).backgroundColor.match(/[0-9]+/g).slice(0, 3).reduce((a, b) => a + Number(b), 0) / 3"


class Everywhere(Page):
    def complaints(self):
        self.value(AXE.read_text(encoding="utf-8") + RUN)
        end = time.monotonic() + 600
        while (told := self.value("window.told")) is None and time.monotonic() < end:
            time.sleep(0.1)
        return json.loads(told or '["no answer"]')

    def look(self, name):
        self.open(name)
        for width, theme, media in VIEWS:
            with self.subTest(width=width, theme=theme, media=media):
                self.browser.call("Emulation.setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1,
                                  mobile=False)
                self.browser.call("Emulation.setEmulatedMedia", media=media,
                                  features=[{"name": "prefers-color-scheme", "value": theme}])
                if media == "print":
                    self.value("window.dispatchEvent(new Event('beforeprint'))")
                self.browser.wait(0.5)  # until it is drawn again
                self.becomes(f"document.documentElement.scrollWidth <= {width}", True)
                self.becomes(f"{BRIGHTNESS} < 100", theme == "dark")
                if media == "print":
                    self.becomes(f"{ON_PAPER} < 721", True)
                if AXE.exists():
                    self.assertEqual(self.complaints(), [])

    def test_every_kind_of_page(self):
        for name, command in CASES.items():
            with self.subTest(page=name):
                quiet = () if command[0] == "sweep" else ("--quiet",)
                self.tool(*command, *quiet, "--report", "page.html")
                self.look("page.html")

    def test_results_over_each_other(self):
        for name, q in ("a.json", "0"), ("b.json", "0.1"):
            self.tool("simulate", "stick-slip", "--set", f"q={q}", "--quiet", "--out", name)
        self.tool("report", "a.json", "b.json", "--out", "page.html")
        self.look("page.html")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])

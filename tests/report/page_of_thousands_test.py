"""Pages of thousands of columns in headless Chromium: how large they are, what they unpack, how true their lines are.

usage: page_of_thousands_test.py TOOL SOURCE BROWSER
"""

import json
import subprocess
import sys
import unittest

import page_in_browser_test as pages


class Thousands(pages.Page):
    """A network of many genes: the page keeps every column, and unpacks those that are drawn."""

    GENES = 400

    def setUp(self):
        super().setUp()
        generator = pages.SOURCE / "benchmarks" / "large" / "large_models.py"
        subprocess.run([sys.executable, generator, "network", str(self.GENES), "-o", self.folder / "m.toml"], check=True)
        self.tool("simulate", "m.toml", "--until", "5", "--quiet", "--report", "page.html", "--out", "r.npz")
        self.open("page.html")
        self.becomes(pages.DRAWN + " >= 2", True)

    def unpacked(self):
        return self.value("Object.entries(Object.getOwnPropertyDescriptors(saltus.result.trajectory.x))"
                          ".filter(([key, about]) => key !== 'length' && about.get === undefined).length")

    def test_only_what_is_drawn_is_unpacked(self):
        self.assertLess((self.folder / "page.html").stat().st_size, 6e6)
        self.assertLess(self.unpacked(), 40)
        self.value("document.querySelector('[title^=\"which columns are drawn\"]').click()")
        self.assertLess(self.unpacked(), 40)
        self.value("(() => { const box = document.querySelector('.column-search'); box.value = 'x399';"
                   " box.dispatchEvent(new Event('input')); })()")
        self.value("document.querySelector('.column-ticks input[aria-label=\"state x399\"], "
                   ".column-ticks input[aria-label^=\"state\"]').click()")
        self.becomes("document.querySelector('.panel-rows').textContent.includes('x399')", True)

    def test_lines_are_close_to_the_rows(self):
        t, x = (self.value(f"JSON.stringify(saltus.result.trajectory.{what})") for what in ("t", "x"))
        t, columns = json.loads(t), json.loads(x)
        self.assertEqual(len(columns), self.GENES)
        tolerance = self.value("saltus.result.trajectory.line_tolerance")
        self.assertGreater(tolerance, 0)
        self.assertLess(tolerance, 2e-3)
        try:
            import numpy
        except ImportError:
            self.skipTest("no numpy")
        with numpy.load(self.folder / "r.npz") as arrays:
            # At events the page has the row before and the one behind, as the archive.
            same = len(arrays["t"]) == len(t)
            self.assertTrue(same)
            for k in range(0, self.GENES, 7):
                exact = arrays[f"x{k + 1}"]
                reach = exact.max() - exact.min()
                self.assertLessEqual(abs(exact - numpy.array(columns[k])).max(), 1.001 * tolerance * reach + 1e-15)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])

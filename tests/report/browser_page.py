"""A page of a report in headless Chromium, for the tests that look at one.

Their usage: X_test.py TOOL SOURCE BROWSER
"""

import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

TOOL, SOURCE, BROWSER = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
sys.path.insert(0, str(SOURCE / "scripts"))
import look_at_report  # noqa: E402  (the path has to be known first)

DRAWN = "document.querySelectorAll('.js-plotly-plot').length"
PLANE = "document.querySelectorAll('.phase-plot')[0]"
NAMES = PLANE + ".data.filter((trace) => trace.x.length > 0).map((trace) => trace.name)"
SELECTED = "document.querySelector('.inspector h3').textContent"


def key(name):
    return ("document.querySelector('.scroller').dispatchEvent(new KeyboardEvent('keydown', "
            f"{{key: '{name}', bubbles: true}}))")


class Page(unittest.TestCase):
    flags = ""

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="saltus-page-")
        self.folder = pathlib.Path(self._folder.name)
        self.browser = look_at_report.Browser(BROWSER, self.flags)

    def tearDown(self):
        self.browser.close()
        self._folder.cleanup()
        self.assertEqual(self.browser.complaints, [])

    def tool(self, *arguments, exit_code=0):
        done = subprocess.run([TOOL, *arguments], cwd=self.folder, capture_output=True, timeout=600)
        self.assertEqual(done.returncode, exit_code, done.stderr)

    def show(self, model):
        self.tool("simulate", model, "--quiet", "--report", "page.html")
        self.open("page.html")

    def open(self, name):
        self.browser.open((self.folder / name).as_uri(), 1366, 768, "light")

    def value(self, expression):
        return self.browser.value(expression)

    def becomes(self, expression, expected):
        """Waits until an expression has a value: drawing takes its time on a busy machine."""
        end = time.monotonic() + 120
        while (found := self.value(expression)) != expected and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual(found, expected, expression)

"""The page that runs models, from a disk: an example, an edited model, a mistake, a run that is stopped."""

import pathlib
import sys

TRY = pathlib.Path(sys.argv.pop(4))
SOURCE = pathlib.Path(sys.argv[2])
sys.path.insert(0, str(SOURCE / "tests/report"))
import browser_page  # noqa: E402  (the path has to be known first)

STATUS = "document.getElementById('status').textContent"
KIND = "document.getElementById('status').className"
RUN = "document.getElementById('run').click()"


class TryPage(browser_page.Page):
    def setUp(self):
        super().setUp()
        self.browser.open(TRY.as_uri(), 1366, 768, "light")
        self.becomes(KIND, "good")

    def edit(self, before, after):
        self.value(f"(() => {{ const m = document.getElementById('model'); m.value = m.value.replace({before!r}, {after!r}); }})()")

    def table(self):
        return self.value("document.getElementById('told').textContent")

    def test_the_first_example_runs_at_once(self):
        self.assertIn("stick-slip", self.table())
        self.assertIn("done in", self.value(STATUS))
        self.assertTrue(self.value("document.getElementById('page').src").startswith("blob:"))

    def test_an_edited_model_gives_other_numbers(self):
        before = self.table()
        self.edit("[simulate]", "[simulate]\nrtol = 1e-4")
        self.value(RUN)
        self.becomes(f"{KIND} === 'good' && document.getElementById('told').textContent !== {before!r}", True)

    def test_a_mistake_is_told_and_selected(self):
        self.edit("[dynamics]", "[dynamixs]")
        self.value(RUN)
        self.becomes(KIND, "bad")
        self.assertIn("dynamixs", self.table())
        selected = "(() => { const m = document.getElementById('model'); return m.value.slice(m.selectionStart, m.selectionEnd); })()"
        self.assertIn("dynamixs", self.value(selected))

    def test_a_run_that_is_stopped_leaves_the_page_ready(self):
        self.edit("until = 40", "until = 1e6")
        self.value(RUN)
        self.becomes(STATUS, "running…")
        self.value("document.getElementById('stop').click()")
        self.becomes(STATUS, "ready")
        self.edit("until = 1e6", "until = 1")
        self.value(RUN)
        self.becomes(KIND, "good")
        self.assertIn("t = 1\n", self.table())

    def test_every_example_runs(self):
        count = self.value("document.getElementById('examples').options.length")
        self.assertGreater(count, 5)
        for number in range(count):
            self.value(f"(() => {{ const e = document.getElementById('examples'); e.selectedIndex = {number}; e.onchange(); }})()")
            self.becomes(KIND, "good")


if __name__ == "__main__":
    browser_page.unittest.main(argv=sys.argv[:1])

"""The page of a sweep in headless Chromium: maps, diagrams of events, lost runs, zoom, choices.

usage: sweep_in_browser_test.py TOOL SOURCE BROWSER
"""

import re
import sys
import unittest

from browser_page import Page

CLICK = "{}.dispatchEvent(new MouseEvent('click', {{bubbles: true}}))"


class Sweep(Page):
    CELLS = ("[...document.querySelector('svg').querySelectorAll('.run')]"
             ".map((cell) => [cell.dataset.run, ...['x', 'width', 'y', 'height'].map((k) => Number(cell.getAttribute(k)))])")
    TICKS = ("Object.fromEntries([...document.querySelector('svg').querySelectorAll('text')]"
             ".map((text) => [text.textContent, Number(text.getAttribute('x'))]))")

    def map_of(self, width):
        self.tool("sweep", "stick-slip", "--until", "5", "--over", "belt=0.4,0.1,0.2", "--over", "q=0,0.05", "--out", "s.csv",
                  "--report", "sweep.html")
        self.browser.open((self.folder / "sweep.html").as_uri(), width, 768, "light")
        return {int(run): place for run, *place in self.value(self.CELLS)}, self.value(self.TICKS)

    def test_cells_of_a_map_lie_around_their_values(self):
        cells, ticks = self.map_of(1366)
        for run, value in (1, "0.4"), (3, "0.1"), (5, "0.2"):
            left, width, _, _ = cells[run]
            self.assertLess(left, ticks[value])
            self.assertLess(ticks[value], left + width)
        # Twice as far from 0.2 to 0.4 as from 0.1 to 0.2, and half-way between them is a border.
        self.assertAlmostEqual(cells[3][0] + cells[3][1], (ticks["0.1"] + ticks["0.2"]) / 2, delta=1)
        self.assertAlmostEqual(cells[5][0] + cells[5][1], (ticks["0.2"] + ticks["0.4"]) / 2, delta=1)

    def test_runs_without_an_event_are_drawn_with_their_number(self):
        self.tool("sweep", "stick-slip", "--until", "5", "--over", "belt=0.1,0.2,5", "--keep", "events", "--report", "sweep.html")
        self.open("sweep.html")
        drawn = ("[...document.querySelectorAll('section.picture')].map((part) => [part.querySelector('h2').textContent,"
                 " [...part.querySelectorAll('.run')].map((dot) => dot.textContent)])")
        counts = dict(self.value(drawn))
        self.assertEqual(counts['number of events "enter_sliding slip"'], ["0.1: 1", "0.2: 1", "5: 0"])
        # One status needs no picture, the head says it.
        self.assertNotIn("status", counts)
        self.assertEqual(self.value("document.querySelector('.badge').textContent"), "3 completed")
        kinds = "[...document.querySelectorAll('#controls select')].at(-1).textContent"
        self.assertNotIn("undefined", self.value(kinds))
        self.value(CLICK.format("[...document.querySelectorAll('section.picture')].at(-1).querySelectorAll('.run')[2]"))
        self.assertIn("run 3: belt = 5; completed, 0 events", self.value("document.getElementById('chosen').textContent"))
        command = self.value("document.getElementById('command').textContent")
        self.assertEqual(command.split(" ", 1)[1], "simulate stick-slip --until 5 --set belt=5 --report run3.html")

    def test_the_page_opens_on_a_value_that_varies(self):
        """At the threshold that an event is about the state has one value in all runs."""
        (self.folder / "m.toml").write_text(
            '[model]\nname = "m"\n[parameters]\nrate = 1\n[states]\nx = 0\ny = 0\n[dynamics]\nx = "rate*step(1 - x)"\ny = "1"\n')
        self.tool("sweep", "m.toml", "--until", "3", "--over", "rate=0.5,1,2", "--keep", "events", "--report", "sweep.html")
        self.open("sweep.html")
        self.assertEqual(self.value("document.querySelector('#controls select').value"), "y")

    def test_runs_whose_solution_is_not_unique_have_a_mark(self):
        (self.folder / "m.toml").write_text(
            '[model]\nname = "m"\n[parameters]\npush = 0\n[states]\nx = 0\n[dynamics]\nx = "sign(x) + push"\n')
        over = ["--over", "push=-3,0,2", "--until", "1"]
        for keep, second in ("final", ()), ("events", ()), ("final", ("--over", "x=0,1")):
            self.tool("sweep", "m.toml", *over, *second, "--keep", keep, "--report", "sweep.html")
            self.open("sweep.html")
            self.assertIn(f"not unique in 1 of {6 if second else 3} runs", self.value("document.querySelector('.banner').textContent"))
            self.assertEqual(self.value("document.querySelector('.banner').className"), "banner notice")
            self.assertEqual(self.value("document.querySelector('section svg').querySelectorAll('.alarm').length"), 1)
            self.value("document.querySelector('.banner button').click()")
            self.assertIn("the solution is not unique", self.value("document.getElementById('chosen').textContent"))

    def test_lines_ascend_and_random_samples_are_points(self):
        line = "document.querySelector('svg g > path:not(.run)')?.getAttribute('d').split(/[ML ]/).filter((word) => word).map(Number)"
        self.tool("sweep", "stick-slip", "--until", "5", "--over", "belt=0.3,0.1,0.2", "--report", "sweep.html")
        self.open("sweep.html")
        across = self.value(line)[::2]
        self.assertEqual(across, sorted(across))
        self.tool("sweep", "stick-slip", "--until", "5", "--sample", "belt=uniform(0.1,0.3)", "--runs", "9", "--report",
                  "sweep.html")
        self.open("sweep.html")
        self.assertIsNone(self.value(line))
        self.assertEqual(self.value("document.querySelector('svg').querySelectorAll('.run').length"), 9)

    def test_of_trajectories_the_ends_are_drawn(self):
        for keep in "trajectory", "final":
            self.tool("sweep", "stick-slip", "--until", "5", "--over", "belt=0.1,0.2", "--keep", keep, "--report",
                      keep + ".html")
            self.open(keep + ".html")
            drawn = re.sub("clip-[a-z0-9]+", "", self.value("document.getElementById('pictures').innerHTML"))
            drawn = re.sub(' data-row="[0-9]+"', "", drawn)
            if keep == "trajectory":
                of_trajectories = drawn
        self.assertEqual(drawn, of_trajectories)

    def test_words_are_inside_of_the_picture(self):
        self.tool("sweep", "stick-slip", "--until", "5", "--over", "simulate.max_steps=3,1000", "--report", "sweep.html",
                  exit_code=3)
        self.open("sweep.html")
        left = ("Math.min(...[...document.querySelectorAll('svg text')].map((text) => text.getBoundingClientRect().left"
                " - text.closest('svg').getBoundingClientRect().left))")
        self.assertGreaterEqual(self.value(left), 0)

    def test_runs_that_stopped_early_are_no_ends(self):
        (self.folder / "m.toml").write_text(
            '[model]\nname = "m"\n[parameters]\na = 1\nb = 1\n[states]\nx = 1\n[dynamics]\nx = "b*sqrt(a - x)*x"\n')
        over = ["--over", "a=2,0,3,4,0.5", "--until", "0.1"]
        self.tool("sweep", "m.toml", *over, "--report", "sweep.html", exit_code=3)
        self.open("sweep.html")
        self.assertIn("2 of 5 runs stopped early", self.value("document.querySelector('.banner').textContent"))
        runs = "[...document.querySelector('section svg').querySelectorAll('{}')].map((mark) => mark.dataset.run)"
        self.assertEqual(self.value(runs.format("circle")), ["1", "3", "4"])
        self.assertEqual(self.value(runs.format(".stopped")), ["2", "5"])
        path = "document.querySelector('section svg g > path:not(.run)').getAttribute('d').replace(/[^ML]/g, '')"
        self.assertEqual(self.value(path), "MLL")
        self.tool("sweep", "m.toml", *over, "--over", "b=1,2", "--report", "sweep.html", exit_code=3)
        self.open("sweep.html")
        grey = "[...document.querySelector('section svg').querySelectorAll('rect.run[fill=\"#999\"]')].map((cell) => cell.dataset.run)"
        self.assertEqual(self.value(grey), ["3", "4", "9", "10"])
        self.assertEqual(self.value(runs.format(".stopped")), ["3", "4", "9", "10"])
        status = "[...document.querySelectorAll('section.picture')].at(-1)"
        cells = f"[...{status}.querySelectorAll('rect.run')].map((cell) => cell.getAttribute('fill'))"
        colours = self.value(cells)
        self.assertEqual((len(colours), len(set(colours))), (10, 2))
        self.assertEqual({colours[k - 1] for k in (3, 4, 9, 10)}, {colours[2]})
        words = self.value(f"[...{status}.querySelectorAll('.swatch')].map((text) => text.textContent)")
        self.assertTrue({"completed", "evaluation_failed"} <= set(words), words)

    def test_letters_keep_their_size_on_narrow_screens(self):
        self.map_of(390)
        size = "(() => { const svg = document.querySelector('svg'); return 12 * svg.clientWidth / svg.viewBox.baseVal.width; })()"
        self.assertGreaterEqual(self.value(size), 11)


CYCLE = """
[model]
name = "cycle"
[parameters]
a = 1
b = 1
[states]
x = 0.5
y = 0
[dynamics]
x = "y"
y = "-b*x - a*y"
[[events]]
name = "peak"
when = "y"
direction = "down"
[simulate]
until = 40
"""


class Diagram(Page):
    """Values at events over one parameter, beside another one."""

    def sweep(self, *more, exit_code=0):
        (self.folder / "cycle.toml").write_text(CYCLE, encoding="utf-8")
        self.tool("sweep", "cycle.toml", *more, "--keep", "events", "--report", "sweep.html", exit_code=exit_code)
        self.open("sweep.html")

    def choose(self, label, text):
        self.value("(() => { const select = [...document.querySelectorAll('#controls label')]"
                   f".find((one) => one.textContent.startsWith('{label} ')).querySelector('select');"
                   f" select.value = [...select.options].find((one) => one.textContent === '{text}').value;"
                   " select.dispatchEvent(new Event('change')); })()")

    def colours(self):
        return self.value("Object.entries(Object.groupBy([...document.querySelector('section svg').querySelectorAll('circle.run')],"
                          " (one) => one.getAttribute('fill'))).map(([, members]) => members.length)")

    def test_a_second_parameter_has_a_colour_for_each_value_or_one_value(self):
        self.sweep("--over", "a=-0.01,0,0.02", "--over", "b=1,2,4")
        self.assertEqual(len(self.colours()), 3)
        legend = "[...document.querySelector('section.picture header').querySelectorAll('.swatch')].map((one) => one.textContent)"
        self.assertEqual(self.value(legend), ["1", "2", "4"])
        self.choose("b", "2")
        self.assertEqual(len(self.colours()), 1)
        runs = "[...new Set([...document.querySelector('section svg').querySelectorAll('.run')].map((one) => one.dataset.run))]"
        self.assertEqual(self.value(runs), ["2", "5", "8"])
        self.choose("over", "b")
        self.assertEqual(len(self.colours()), 3)

    def test_a_run_without_events_is_drawn_by_its_end(self):
        self.sweep("--over", "a=0,3", "--set", "x=-0.5")
        self.value("(() => { const box = document.querySelector('.after'); box.value = '5';"
                   " box.dispatchEvent(new Event('change')); })()")
        ends = "[...document.querySelector('section svg').querySelectorAll('.end')].map((one) => one.dataset.run)"
        self.assertEqual(self.value(ends), ["2"])
        self.assertIn("after t = 5", self.value("document.querySelector('section h2').textContent"))
        self.assertIn("where a run has no \"peak\"", self.value("document.querySelector('section header').textContent"))
        # Nothing is drawn of times that no run reaches.
        self.value("(() => { const box = document.querySelector('.after'); box.value = '50';"
                   " box.dispatchEvent(new Event('change')); })()")
        self.assertEqual(self.value(ends), [])

    def test_lost_runs_are_marked_in_every_picture(self):
        self.sweep("--over", "a=0,0.1", "--over", "simulate.max_events=3,1000", exit_code=3)
        pictures = "[...document.querySelectorAll('section.picture')]"
        marks = f"{pictures}.map((one) => new Set([...one.querySelectorAll('.stopped')].map((mark) => mark.dataset.run)).size)"
        found = self.value(marks)
        self.assertEqual(len(found), 3)
        self.assertTrue(all(count == 2 for count in found), found)
        self.assertEqual(self.value("[...document.querySelectorAll('.badge')].map((one) => one.className)"),
                         ["badge bad", "badge good"])

    def test_dragging_zooms_and_a_double_click_shows_all(self):
        self.sweep("--over", "a=0:0.3:31")
        ticks = "[...document.querySelector('section svg').querySelectorAll('text')].map((one) => one.textContent)"
        before = self.value(ticks)
        self.value("document.querySelector('section svg').scrollIntoView()")
        x, y, width, height = self.value("(() => { const box = document.querySelector('section svg').getBoundingClientRect();"
                                         " return [box.x, box.y, box.width, box.height]; })()")
        start, end = (x + 0.4 * width, y + 0.2 * height), (x + 0.5 * width, y + 0.6 * height)
        self.browser.mouse("mouseMoved", *start)
        self.browser.mouse("mousePressed", *start, buttons=1)
        self.browser.mouse("mouseMoved", *end, buttons=1)
        self.browser.mouse("mouseReleased", *end)
        zoomed = self.value(ticks)
        self.assertNotEqual(zoomed, before)
        numbers = [float(text) for text in zoomed[:3]]
        self.assertTrue(all(0.05 < number < 0.2 for number in numbers), zoomed)
        self.value("document.querySelector('section svg').dispatchEvent(new MouseEvent('dblclick', {bubbles: true}))")
        self.assertEqual(self.value(ticks), before)
        self.value("document.querySelector('section svg').dispatchEvent(new KeyboardEvent('keydown', {key: '+', bubbles: true}))")
        self.assertNotEqual(self.value(ticks), before)

    def test_it_looks_as_the_other_pages_and_nothing_covers_a_picture(self):
        self.sweep("--over", "a=0:0.3:4", "--over", "b=1,2")
        for width in (1400, 390):
            self.browser.open((self.folder / "sweep.html").as_uri(), width, 800, "light")
            self.assertEqual(self.value("document.documentElement.scrollWidth"), width)
            covered = ("[...document.querySelectorAll('.sweep-picture')].filter((one) => { one.scrollIntoView({block: 'center'});"
                       " const box = one.getBoundingClientRect(); const top = document.elementFromPoint(box.x + box.width / 2,"
                       " Math.min(innerHeight - 2, box.y + box.height / 2)); return !one.contains(top); }).length")
            self.assertEqual(self.value(covered), 0)
        self.value("document.querySelector('.theme').click()")
        self.assertEqual(self.value("document.documentElement.dataset.theme"), "dark")
        dark = self.value("getComputedStyle(document.body).backgroundColor")
        self.value("window.dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(self.value("document.documentElement.dataset.theme"), "light")
        self.assertNotEqual(self.value("getComputedStyle(document.body).backgroundColor"), dark)
        right = "Math.max(...[...document.querySelectorAll('svg')].map((one) => one.getBoundingClientRect().right))"
        self.assertLess(self.value(right), 721)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])

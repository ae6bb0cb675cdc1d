"""Pages of what is more than one simulation of few states: comparisons, branches, optimisations, thousands of columns.

usage: results_in_browser_test.py TOOL SOURCE BROWSER
"""

import json
import subprocess
import sys
import unittest

from browser_page import DRAWN, NAMES, SOURCE, TOOL, Page


class Source(Page):
    def test_the_page_has_the_model_the_start_and_its_rows(self):
        self.tool("simulate", "stick-slip", "--set", "q=0.1", "--quiet", "--report", "page.html")
        self.open("page.html")
        source = (SOURCE / "models/stick-slip.toml").read_text(encoding="utf-8")
        self.assertEqual(self.value("document.querySelector('.info details pre').textContent"), source)
        cards = "[...document.querySelectorAll('.info .card')].map((card) => card.textContent)"
        start = [text for text in self.value(cards) if text.startswith("Start")][0]
        self.assertIn("q0.1", start)
        self.assertIn("saltus simulate stick-slip --set q=0.1", start)
        # What the button saves has the columns of the tool's own file.
        self.tool("simulate", "stick-slip", "--set", "q=0.1", "--quiet", "--out", "r.csv")
        header = (self.folder / "r.csv").read_text(encoding="utf-8").splitlines()[0]
        self.assertEqual(self.value("saltus.toCsv(saltus.result).split('\\r\\n')[0]"), header)


    def test_words_beside_equations_are_whole_on_narrow_screens(self):
        self.tool("simulate", "chua", "--quiet", "--report", "page.html")
        self.browser.open((self.folder / "page.html").as_uri(), 390, 844, "light")
        word = "[...document.querySelectorAll('.equations td.quiet')].find((cell) => cell.textContent === 'output')"
        self.assertEqual(self.value(f"(() => {{ const range = document.createRange(); range.selectNodeContents({word});"
                                    " return range.getClientRects().length; })()"), 1)


class Overlays(Page):
    def test_two_results_over_each_other_with_their_differences(self):
        self.tool("simulate", "stick-slip", "--quiet", "--out", "a.json")
        self.tool("simulate", "stick-slip", "--set", "q=0.1", "--rtol", "1e-6", "--quiet", "--out", "b.json")
        self.tool("report", "a.json", "b.json", "--out", "both.html")
        self.open("both.html")
        overlays = "document.querySelector('.timeline').data.filter((trace) => trace.meta === 'overlay').length"
        self.assertEqual(self.value(overlays), 3)
        self.assertIn("b.json", self.value(NAMES))
        self.assertIn("of the range of", self.value("document.querySelector('.overlays').textContent"))
        self.assertIn("Differences", self.value("[...document.querySelectorAll('.phase h2')].map((e) => e.textContent)"))
        largest = self.value("Math.max(...document.querySelectorAll('.phase-plot')[1].data[0].y.map(Math.abs))")
        self.assertGreater(largest, 0.05)
        self.assertLess(largest, 2)


    def test_differences_have_both_sides_of_jumps_and_no_gaps(self):
        for name, e in ("a.json", "0.9"), ("b.json", "0.7"):
            self.tool("simulate", "bouncing-ball", "--set", f"e={e}", "--until", "5", "--quiet", "--out", name)
        self.tool("report", "a.json", "b.json", "--out", "both.html")
        self.open("both.html")
        line = "document.querySelectorAll('.phase-plot')[1].data[0]"
        gaps = line + ".y.filter((value) => value === null).length"
        steps = f"{line}.x.filter((t, i, x) => t === x[i - 1] && Math.abs({line}.y[i] - {line}.y[i - 1]) > 1).length"
        self.assertEqual((self.value(gaps), self.value(steps)), (0, 0))
        # The velocity jumps, at other times in each.
        self.value("(() => { const pick = document.querySelector('select[aria-label=column]');"
                   " pick.value = 1; pick.dispatchEvent(new Event('change')); })()")
        self.becomes(steps + " > 2", True)
        self.assertEqual(self.value(gaps), 0)


    def test_cards_that_scroll_are_reached_by_the_keyboard(self):
        for name, q in ("a.json", "0"), ("b.json", "0.1"):
            self.tool("simulate", "stick-slip", "--set", f"q={q}", "--quiet", "--out", name)
        self.tool("report", "a.json", "b.json", "--out", "both.html")
        self.browser.open((self.folder / "both.html").as_uri(), 390, 800, "light")
        scrolling = ("[...document.querySelectorAll('.card')].filter((card) => getComputedStyle(card).overflowX === 'auto'"
                     " && card.scrollWidth > card.clientWidth).map((card) => [card.tabIndex, card.getAttribute('aria-label')])")
        self.assertEqual(self.value(scrolling), [[0, "Results laid over this one"]])


class Comparison(Page):
    def test_on_narrow_screens_it_scrolls_in_its_card_and_says_so(self):
        self.tool("compare", "stick-slip", "--until", "5", "--quiet", "--report", "c.html")
        self.browser.open((self.folder / "c.html").as_uri(), 390, 844, "light")
        card = "document.querySelector('.comparison')"
        self.assertEqual(self.value("document.documentElement.scrollWidth"), 390)
        self.assertGreater(self.value(f"{card}.scrollWidth - {card}.clientWidth"), 100)
        self.assertIn("local", self.value(f"getComputedStyle({card}).backgroundAttachment"))
        self.value(f"(() => {{ {card}.scrollLeft = 10000; }})()")
        left = f"{card}.querySelector('tbody td').getBoundingClientRect().left - {card}.getBoundingClientRect().left"
        self.assertLess(abs(self.value(left)), 2)

    def test_a_run_without_states_has_all_its_cells(self):
        self.tool("compare", "stick-slip", "--until", "5", "--quiet", "--out", "c.json")
        compared = json.loads((self.folder / "c.json").read_text(encoding="utf-8"))
        compared["comparison"]["runs"][2]["x"] = []  # as of one that stopped at its start
        (self.folder / "c.json").write_text(json.dumps(compared), encoding="utf-8")
        self.tool("report", "c.json")
        self.open("c.html")
        cells = "[...document.querySelectorAll('.comparison tr')].map((row) => row.cells.length)"
        self.assertEqual(len(set(self.value(cells))), 1)
        third = "document.querySelectorAll('.comparison tbody tr')[2].textContent"
        self.assertIn("––", self.value(third))


ROTATING = """
[model]
name = "entry"
[states]
x = 0
y = -1
[switching]
first = "x"
second = "y"
[[modes]]
when = "first < 0 and second < 0"
dynamics = { x = "0.5223", y = "0.609" }
[[modes]]
when = "first < 0 and second > 0"
dynamics = { x = "-0.194", y = "0.3146" }
[[modes]]
when = "first > 0 and second < 0"
dynamics = { x = "-1.7734", y = "-0.9416" }
[[modes]]
when = "first > 0 and second > 0"
dynamics = { x = "1.011", y = "0.115" }
[simulate]
until = 6
[simulate.event]
branches = "all"
"""


class Branches(Page):
    def show_tree(self):
        (self.folder / "m.toml").write_text(ROTATING, encoding="utf-8")
        self.show("m.toml")

    def test_are_listed_and_drawn_dashed_and_the_chosen_one_solid(self):
        self.show_tree()
        rows = "document.querySelectorAll('.branches tbody tr')"
        self.assertGreater(self.value(rows + ".length"), 0)
        drawn = ("document.querySelector('.timeline').data.filter((trace) => trace.meta === 'branches')"
                 ".map((trace) => trace.line.dash)")
        self.assertEqual(set(self.value(drawn)), {"dash"})
        self.assertIn("branches", self.value(NAMES))
        self.value(rows + "[0].click()")
        self.becomes(drawn + ".includes('solid')", True)
        self.becomes(NAMES + ".includes('branch 1')", True)
        self.value(rows + "[0].click()")
        self.becomes(drawn + ".includes('solid')", False)
        self.value("document.querySelector('.branches tbody button').click()")
        self.becomes("document.querySelector('.inspector').hidden", False)

    def test_the_square_of_a_decision_has_zeros_path_and_points(self):
        self.show_tree()
        square = "document.querySelector('.phase-plot.square')"
        names = self.value(square + ".data.map((trace) => trace.name)")
        self.assertIn("hidden dynamics", names)
        self.assertEqual(names[-2:], ["comes from", "goes on with"])
        for name in ("g₁ = 0 (first)", "g₂ = 0 (second)"):
            self.assertIn(name, names)
        # Comes along x = 0 from below y = 0, and rests where both components vanish.
        come = self.value(square + ".data.at(-2).x[0]"), self.value(square + ".data.at(-2).y[0]")
        self.assertAlmostEqual(come[0], 0.5223 / (0.5223 + 1.7734), 9)
        self.assertEqual(come[1], 0)
        size = self.value("(() => { const data = " + square + ".data, p = data.at(-1);"
                          " return saltus.normalComponents(saltus.result"
                          ".events.find((e) => e.intersection).intersection, [p.x[0], p.y[0]]).map(Math.abs); })()")
        self.assertLess(max(size), 1e-9)


def optimised(result):
    """The result of an optimisation with the trajectory of a simulation without controls, in four intervals."""
    rows, until = result["trajectory"], result["final"]["t"]
    zero = {"termination": "completed", "message": "", "end_state_error": 0, "terminal_violation": 0, "amplification": 2}
    step = {"solver": "ipopt", "iterations": 7, "objective": 3, "primal_infeasibility": 0, "complementarity_residual": 0,
            "termination": "completed", "seconds": 0}
    return {
        **result, "command": "optimize", "objective": 3, "horizon": until, "parameters": {"mass": 2}, "u": [[]] * 4,
        "objective_terms": {"running": 1, "terminal": 2, "least_squares": 0, "time": 0, "penalties": 0},
        "grid": [until * k / 4 for k in range(5)], "h": [[until / 8] * 2] * 4,
        "multipliers": [{"name": "v <= 1", "time": until, "value": 0.5}, {"name": "q == 2", "time": until, "value": -1}],
        "homotopy": [{**step, "phase": "relaxed", "sigma": 1}, {**step, "phase": "branch", "sigma": 1}],
        "certificate": {"primal_infeasibility": 1e-12, "complementarity_residual": 0, "stationarity": 1e-10, "biactive": 0,
                        "stationarity_type": "S", "b_stationary": True, "lpcc_decrease": None},
        "verification": {"tolerance": 1e-3, "interval_defect": 0.5, "interval": 2, "state": "v", "switch_time_error": 0,
                         "switches_missed": 0, "switches_extra": 0, "path_violation": 0, "message": "",
                         "open_loop": {**zero, "t": rows["t"], "x": rows["x"]}},
        "statistics": {"iterations": 14, "variables": 3, "equations": 2, "pairs": 1, "build_seconds": 0,
                       "evaluation_seconds": 0, "linear_algebra_seconds": 0, "wall_seconds": 1},
        "start_values": {"nodes": [], "state_lower": [None, -0.5], "state_upper": [None, 0.3], "control_lower": [],
                         "control_upper": [], "primal": [], "dual_rows": [], "dual_lower": [], "dual_upper": []},
    }


class Optimisation(Page):
    def setUp(self):
        super().setUp()
        self.tool("simulate", "stick-slip", "--quiet", "--out", "simulated.json")
        simulated = json.loads((self.folder / "simulated.json").read_text(encoding="utf-8"))
        del simulated["record_sha256"]
        (self.folder / "page.json").write_text(json.dumps(optimised(simulated)), encoding="utf-8")
        # Neither model nor solver: everything is in the result.
        self.tool("report", "page.json")
        self.open("page.html")

    def test_words_and_drawings(self):
        titles = "[...document.querySelectorAll('.phase h2')].map((title) => title.textContent)"
        self.assertEqual(self.value(titles), ["Phase plane", "Simulated against optimised", "Multipliers of constraints",
                                              "Lengths of elements", "Path of problems"])
        self.assertEqual(self.value(DRAWN), 6)
        self.assertEqual(self.value("document.querySelectorAll('.verdict li.good').length"), 4)
        self.assertEqual(self.value("[...document.querySelectorAll('.verdict li.bad')].map((said) => "
                                    "said.textContent.includes('0.5 of the range of `v` in interval 2 (t ='))"), [True])
        metas = ("document.querySelector('.timeline').data.map((trace) => trace.meta)"
                 ".filter((meta) => meta && !meta.startsWith('mode'))")
        self.assertEqual(self.value(metas), ["simulated", "bound", "bound", "simulated"])

    def test_one_constraint_can_be_chosen_and_zooming_is_for_all(self):
        shown = "document.querySelectorAll('.phase-plot')[2].data.map((trace) => trace.name).filter((name) => name)"
        self.assertEqual(self.value(shown), ["q == 2", "v &lt;= 1"])
        self.value("(() => { const list = document.querySelector('select.wide'); list.value = '1';"
                   " list.dispatchEvent(new Event('change')); })()")
        self.becomes(shown, ["v &lt;= 1"])
        self.value("document.querySelectorAll('.phase-plot')[1].emit('plotly_relayout',"
                   " {'xaxis.range[0]': 5, 'xaxis.range[1]': 6})")
        self.becomes("document.querySelector('.timeline').layout.xaxis.range", [5, 6])
        self.becomes("document.querySelectorAll('.phase-plot')[3].layout.xaxis.range", [5, 6])


class Thousands(Page):
    """A network of many genes: the page keeps every column, and unpacks those that are drawn."""

    GENES = 400

    def setUp(self):
        super().setUp()
        words = [TOOL, "models", "gene-network", "--set", f"genes={self.GENES}"]
        with open(self.folder / "m.toml", "wb") as file:
            subprocess.run(words, stdout=file, check=True)
        self.tool("simulate", "m.toml", "--until", "5", "--quiet", "--report", "page.html", "--out", "r.npz")
        self.open("page.html")
        self.becomes(DRAWN + " >= 2", True)

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
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[4:]])

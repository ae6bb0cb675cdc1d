"""saltus compare: its table, its record, its page and its refusals."""

import json

import tool

STOPS = """
[model]
name = "falls"
[states]
x = 1.0
[dynamics]
x = "-1 - step(x - 0.5)"
[[events]]
name = "ground"
when = "x"
stop = true
[simulate]
until = 9
"""

NO_LIMIT = """
[model]
name = "blows-up"
[states]
x = 1.0
[dynamics]
x = "x^2"
[simulate]
until = 2
"""


class Compare(tool.ToolTest):
    def comparison(self, model, *arguments, code=0):
        self.run_tool("compare", model, "--out", "c.json", "--quiet", *arguments, code=code)
        return json.loads((self.folder / "c.json").read_text(encoding="utf-8"))

    def runs(self, result, method):
        return [run for run in result["comparison"]["runs"] if run["method"] == method]

    def test_engines_agree_on_stick_slip(self):
        result = self.comparison("stick-slip")
        reference = result["comparison"]["runs"][result["comparison"]["reference"]]
        self.assertEqual(result["command"], "compare")
        self.assertAlmostEqual(reference["x"][0], 0.62894363667354, 12)  # closed form by pieces
        self.assertEqual(reference["x"], result["final"]["x"])
        for run in self.runs(result, "event"):
            self.assertEqual(run["switches"], 9)
            self.assertAlmostEqual(run["last_switch"], 37.3278763564967, 7)
            self.assertLess(run["state_difference"], 1e-8)
            self.assertLess(run["switch_time_difference"], 1e-7)
        smoothed, = self.runs(result, "smoothed")
        self.assertIsNone(smoothed["switches"])  # it has layers, no switches
        self.assertLess(smoothed["state_difference"], 1e-4)
        self.assertGreater(smoothed["state_difference"], 1e-8)

    def test_the_table_has_a_row_for_every_run_and_a_reason_for_every_other(self):
        result = self.comparison("irma")
        table, _ = self.run_tool("compare", "irma", code=0)
        lines = table.splitlines()
        self.assertTrue(lines[0].startswith("model       irma"))
        for run in result["comparison"]["runs"]:
            if "reason" in run:
                self.assertIn(run["reason"].split()[-1], table.split("not run")[1])
            else:
                self.assertTrue(any(line.split()[0] == run["method"] and run["variant"] in line for line in lines[2:]))
        self.assertIn("reference", table)

    def test_explicit_methods_are_not_tried_on_a_stiff_model(self):
        # Elements without switch detection are too long for the layer, and stop early.
        runs = self.runs(self.comparison("smoothed-pss", code=3), "event")
        self.assertEqual([("reason" in run) for run in runs], [False, True, True, False, True])
        self.assertIn("stiff", runs[1]["reason"])

    def test_a_solution_that_is_not_unique_is_told(self):
        table, _ = self.run_tool("compare", "spontaneous-switch", code=0)
        self.assertIn("not unique  the solution has other continuations at t = 0", table)

    def test_settings_and_end(self):
        result = self.comparison("stick-slip", "--until", "5", "--set", "belt=0.25", "--rtol", "1e-5")
        self.assertEqual(result["final"]["t"], 5.0)
        self.assertEqual(result["model"]["parameters"]["belt"], 0.25)
        reference, dopri5 = self.runs(result, "event")[:2]
        self.assertEqual(result["options"]["simulate.rtol"], 1e-13)
        self.assertGreater(dopri5["state_difference"], 1e-9)
        self.assertGreater(reference["statistics"]["steps"], dopri5["statistics"]["steps"])

    def test_a_stop_event_is_an_end(self):
        result = self.comparison(self.write("falls.toml", STOPS))
        for run in self.runs(result, "event"):
            self.assertEqual(run["status"]["termination"], "stopped_by_event")
            self.assertLess(run["state_difference"], 1e-12)
            self.assertEqual(run["switches"], 1)

    def test_runs_that_stop_early_are_told(self):
        model = self.write("m.toml", NO_LIMIT)
        result = self.comparison(model, code=3)
        # States are compared at the last time that the runs have in common.
        common = result["comparison"]["time"]
        compared = [run for run in result["comparison"]["runs"] if run.get("x") and run["method"] == "event"]
        self.assertGreater(len(compared), 3)
        for run in compared:
            self.assertGreaterEqual(run["status"]["time_reached"], common)
            self.assertLess(run["state_difference"], 1e-2)
        table, errors = self.run_tool("compare", model, code=3)
        self.assertIn("the last time that the runs have in common", " ".join(table.split()))
        self.assertIn("stopped early", table)
        self.assertIn("stopped early", errors)

    def test_what_completed_runs_say_is_told(self):
        # In Stewart's form z feels a weight that no equation determines.
        model = self.write("free.toml", '[model]\nname = "free"\n[states]\nx = 0.5\ny = -0.2\nz = 0\n[dynamics]\n'
                           'x = "-1.5*sign(x) + 0.4*sign(x)*sign(y)"\ny = "-2*sign(y) + 0.7*sign(x)"\n'
                           'z = "sign(x)*sign(y)"\n[simulate]\nuntil = 2\n')
        table, _ = self.run_tool("compare", model, "--report", "c.html", code=0)
        remarks = " ".join(table[table.index("remarks"):].split())
        self.assertIn("fesd (radau_iia 2, stewart, 100 steps): from t = ", remarks)
        self.assertIn("the solution is one of many", remarks)

    def test_a_stored_comparison_gives_the_same_page(self):
        self.run_tool("compare", "crossing", "--out", "c.json", "--report", "c.html", "--quiet", code=0)
        self.run_tool("report", "c.json", "--out", "again.html", code=0)
        page = (self.folder / "c.html").read_bytes()
        self.assertEqual(page, (self.folder / "again.html").read_bytes())
        self.assertIn(b'"comparison":{"reference":0', page)

    def test_refusals(self):
        for arguments, message in ((("crosing",), "did you mean 'crossing'?"),
                                   (("crossing", "--out", "c.csv"), "must end in .json"),
                                   (("crossing", "--method", "event"), "unexpected argument '--method'"),
                                   (("crossing", "--until", "0"), "until (0) is not after from (0)")):
            out, err = self.run_tool("compare", *arguments, code=2)
            self.assertIn(message, err)
            self.assertEqual(out, "")

    def test_a_broken_record_is_refused(self):
        result = self.comparison("crossing")
        result["comparison"]["reference"] = 99
        self.write("broken.json", json.dumps(result))
        _, err = self.run_tool("report", "broken.json", code=2)
        self.assertIn("/comparison/reference", err)


if __name__ == "__main__":
    tool.main()

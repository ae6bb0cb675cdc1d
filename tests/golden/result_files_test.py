"""JSON, CSV and report files of a run."""

import csv
import hashlib
import json
import re

import tool

KEYS = ["format", "saltus", "model", "command", "method", "status", "states", "controls", "switching_functions",
        "outputs", "final", "events", "trajectory", "surfaces", "statistics", "options"]
EVENT_KEYS = ["t", "kind", "name", "surfaces", "mode_before", "mode_after", "alpha_before", "alpha_after", "x",
              "x_after", "unique", "alternatives", "reason"]


class Json(tool.ToolTest):
    def setUp(self):
        super().setUp()
        self.run_tool("simulate", "stick-slip", "--out", "r.json", "--out", "r.csv", "--quiet", code=0)
        self.result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def test_keys_in_order(self):
        self.assertEqual(list(self.result), KEYS)
        self.assertEqual(list(self.result["model"])[:3], ["name", "sha256", "parameters"])
        self.assertEqual(list(self.result["status"]), ["termination", "message", "time_reached"])
        self.assertEqual(list(self.result["final"]), ["t", "x", "mode", "alpha", "outputs"])
        self.assertEqual(list(self.result["trajectory"]), ["t", "x", "u", "alpha", "mode", "outputs"])
        self.assertEqual(list(self.result["statistics"]), ["steps", "rejected", "rhs_evaluations", "wall_seconds"])
        for event in self.result["events"]:
            self.assertEqual(list(event), EVENT_KEYS)

    def test_content(self):
        result = self.result
        self.assertEqual(result["format"], "saltus-result/1")
        self.assertEqual(result["model"]["sha256"],
                         hashlib.sha256((tool.SOURCE / "models/stick-slip.toml").read_bytes()).hexdigest())
        self.assertEqual(result["status"]["termination"], "completed")
        self.assertEqual(result["states"], ["q", "v"])
        self.assertEqual(result["switching_functions"], ["slip"])
        self.assertAlmostEqual(result["final"]["x"][0], 0.62894363667354, 6)
        self.assertEqual(result["options"]["simulate.rtol"], 1e-8)
        self.assertEqual(result["options"]["simulate.event.integrator"], "dopri5")
        self.assertEqual(result["options"]["simulate.output.points"], 1001)

    def test_surfaces_are_recorded(self):
        surface, = self.result["surfaces"]
        self.assertEqual((surface["name"], surface["role"], surface["states"]), ("slip", "switching", ["v"]))
        self.assertEqual(surface["affine"], {"gradient": [1.0], "rate": 0.0, "constant": -0.2})
        self.run_tool("simulate", "circle", "--out", "circle.json", "--quiet", code=0)
        circle = json.loads((self.folder / "circle.json").read_text(encoding="utf-8"))["surfaces"][0]
        self.assertIsNone(circle["affine"])
        self.assertEqual(len(circle["curves"]), 1)
        self.assertGreater(len(circle["curves"][0]["coordinates"][0]), 50)

    def test_every_event_has_two_rows(self):
        times = self.result["trajectory"]["t"]
        for event in self.result["events"]:
            self.assertGreaterEqual(times.count(event["t"]), 2)

    def test_csv_holds_the_same_trajectory(self):
        with open(self.folder / "r.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        self.assertEqual(rows[0], ["t", "q", "v", "alpha(slip)", "mode(slip)"])
        trajectory = self.result["trajectory"]
        self.assertEqual(len(rows) - 1, len(trajectory["t"]))
        for row, t, x in zip(rows[1:], trajectory["t"], trajectory["x"]):
            self.assertEqual([float(field) for field in row[:3]], [t, *x])

    def test_the_page_of_a_stored_result_is_that_of_the_run(self):
        out, _ = self.run_tool("report", "r.json", code=0)
        self.assertEqual(out, "r.html\n")
        page = (self.folder / "r.html").read_text(encoding="utf-8")
        self.assertIn("stick-slip", page)
        self.assertNotRegex(page, r"<(script|link)[^>]+(src|href)=")
        self.run_tool("report", "r.json", "--out", "other.html", code=0)
        self.assertEqual(page, (self.folder / "other.html").read_text(encoding="utf-8"))

    def test_runs_write_equal_results_but_for_the_clock(self):
        self.run_tool("simulate", "stick-slip", "--out", "s.json", "--quiet", code=0)
        def timeless(name):
            return re.sub(r'"wall_seconds": [^\n]*', "", (self.folder / name).read_text(encoding="utf-8"))
        self.assertEqual(timeless("r.json"), timeless("s.json"))


class Branches(tool.ToolTest):
    def test_are_results_of_the_same_form(self):
        out, _ = self.run_tool("simulate", "spontaneous-switch", "--branch", "all", "--out", "r.json", "--out", "r.csv",
                               code=0)
        self.assertIn("branches    2\n", out)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertEqual(list(result), [*KEYS, "branches"])
        self.assertEqual(result["options"]["simulate.event.branches"], 64)
        ends = [result["final"]["x"][0]]
        for branch in result["branches"]:
            # To stay at 0 is to be able to leave at any later time.
            stays = branch["events"][0]["mode_after"] == [0]
            self.assertEqual(list(branch), [*KEYS, *(["families"] if stays else []), "left_at"])
            self.assertEqual(branch["model"], result["model"])
            left = branch["left_at"]
            taken = result["events"][left["event"]]["alternatives"][left["alternative"]]
            self.assertEqual(branch["events"][0]["mode_after"], taken["mode"])
            ends.append(branch["final"]["x"][0])
        self.assertEqual(sorted(round(x, 12) for x in ends), [-1, 0, 1])
        with open(self.folder / "r.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["branch"] for row in rows}, {"main", "1", "2"})
        self.assertEqual(float(rows[-1]["x"]), result["branches"][1]["final"]["x"][0])
        self.run_tool("report", "r.json", code=0)

    def test_members_of_families_are_followed_and_shown(self):
        out, _ = self.run_tool("simulate", "spontaneous-switch", "--branch", "all", "--set", "simulate.event.members=1",
                               "--out", "r.json", code=0)
        self.assertIn("branches    4\n", out)
        self.assertRegex(out, r"families    2, behind event 1: may leave into - at any time from 0 to 1\n")
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        staying = result["branches"][1]
        self.assertEqual([family["kind"] for family in staying["families"]], ["later_departure"] * 2)
        for member in staying["branches"]:
            left = member["left_at"]
            self.assertEqual(set(left), {"event", "family", "parameter"})
            family = staying["families"][left["family"]]
            self.assertEqual(left["parameter"], (family["from"] + family["until"]) / 2)
            self.assertEqual(member["events"][0]["t"], left["parameter"])
            self.assertEqual(member["events"][0]["mode_after"], family["to"]["mode"])
            self.assertAlmostEqual(member["final"]["x"][0], family["to"]["mode"][0] / 2)
        self.run_tool("report", "r.json", code=0)
        self.assertIn("families", (self.folder / "r.html").read_text(encoding="utf-8"))
        err = self.run_tool("simulate", "spontaneous-switch", "--set", "simulate.event.members=-1", code=2)[1]
        self.assertIn("a whole number >= 0", err)

    def test_a_branch_that_stops_early_is_told(self):
        # Downwards the right-hand side ends at x = -1/2.
        model = self.write("m.toml", '[model]\nname = "m"\n[states]\nx = 0\n[dynamics]\n'
                                     'x = "sign(x)/(x + 0.5)"\n[simulate]\nuntil = 5\nmax_steps = 1000\n'
                                     '[simulate.event]\nbranches = "all"\n[[events]]\nwhen = "x + 0.49"\nstop = true\n')
        self.run_tool("simulate", model, code=0)
        model.write_text(model.read_text().split("[[events]]")[0])
        out, err = self.run_tool("simulate", model, "--out", "r.json", code=3)
        self.assertIn("branch 1 stopped early: ", err)
        self.assertIn("completed at t = 5\n", out)
        self.assertTrue((self.folder / "r.json").exists())


class Atomicity(tool.ToolTest):
    def test_an_existing_file_survives_a_run_that_fails(self):
        model = self.write("m.toml", '[model]\nname = "m"\n[states]\nx = 0\n[dynamics]\nx = "y"\n[simulate]\nuntil = 1\n')
        self.write("r.json", "precious")
        self.run_tool("simulate", model, "--out", "r.json", code=2)
        self.assertEqual((self.folder / "r.json").read_text(), "precious")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["m.toml", "r.json"])

    def test_the_input_is_never_overwritten(self):
        self.run_tool("simulate", "crossing", "--out", "r.json", "--quiet", code=0)
        before = (self.folder / "r.json").read_bytes()
        self.run_tool("report", "r.json", "--out", "r.json", code=2)
        self.assertEqual((self.folder / "r.json").read_bytes(), before)


class Malformed(tool.ToolTest):
    def refused(self, name, expected):
        _, err = self.run_tool("report", name, code=2)
        self.assertIn(expected, err)
        self.assertIn(str(name), err)

    def test_results(self):
        self.refused("none.json", "no such file")
        self.write("empty.json", "")
        self.refused("empty.json", "the file is empty")
        self.write("cut.json", '{\n  "format": "saltus-result/1",\n  "mod')
        self.refused("cut.json", "cut.json:3:")
        self.write("other.json", '{"a": 1}')
        self.refused("other.json", "'format' is missing")
        self.write("newer.json", '{"format": "saltus-result/9"}')
        self.refused("newer.json", "saltus-result/9")
        self.assertFalse(list(self.folder.glob("*.html")))


if __name__ == "__main__":
    tool.main()

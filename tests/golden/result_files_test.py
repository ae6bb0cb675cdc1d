"""JSON, CSV and report files of a run."""

import ast
import csv
import datetime
import hashlib
import json
import math
import re
import struct
import zipfile

import contacts_test
import tool

KEYS = ["format", "saltus", "record_sha256", "model", "command", "command_line", "date", "method", "status", "states", "controls", "switching_functions",
        "outputs", "final", "events", "trajectory", "surfaces", "vector_field", "statistics", "options"]
OF_ONE_STATE = [key for key in KEYS if key != "vector_field"]
EVENT_KEYS = ["t", "kind", "name", "surfaces", "mode_before", "mode_after", "alpha_before", "alpha_after", "x",
              "x_after", "unique", "alternatives", "reason"]


def timeless(text):
    """The text of a JSON result without what the clock says."""
    return re.sub(r'"(wall_seconds|date)": [^\n]*', "", text)


class Json(tool.ToolTest):
    def setUp(self):
        super().setUp()
        self.run_tool("simulate", "stick-slip", "--out", "r.json", "--out", "r.csv", "--quiet", code=0)
        self.result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def test_errors_are_estimated_for_the_rows_that_are_written(self):
        """A second run has rows of its own, which are in no file."""
        def result_of(*arguments):
            self.run_tool("simulate", "stick-slip", "--until", "3", "--rtol", "1e-6", "--quiet", "--out", "e.json", *arguments, code=0)
            return json.loads((self.folder / "e.json").read_text(encoding="utf-8"))

        plain, result = result_of(), result_of("--error-estimate")
        self.assertEqual(result["trajectory"], plain["trajectory"])
        self.assertEqual(result["events"], plain["events"])
        errors = result["error_estimate"]
        self.assertEqual(len(errors["x"]), len(result["trajectory"]["t"]))
        self.assertEqual(len(errors["event_times"]), len(result["events"]))
        self.assertLess(max(max(row) for row in errors["x"]), 1e-4)
        self.assertGreater(max(max(row) for row in errors["x"]), 0)

    def test_errors_of_methods_whose_tolerances_are_no_steps(self):
        """Of elements by shorter ones, of what is smoothed by a smaller width: as large as those against the event engine."""
        def result_of(*arguments):
            self.run_tool("simulate", "stick-slip", "--until", "1", "--quiet", "--out", "e.json", *arguments, code=0)
            return json.loads((self.folder / "e.json").read_text(encoding="utf-8"))

        exact = result_of("--rtol", "1e-12")["final"]["x"]
        for method in ("fesd", "timestepping", "smoothed"):
            width = () if method != "smoothed" else ("--set", "simulate.smoothed.epsilon=1e-3")
            result = result_of("--method", method, "--error-estimate", *width)
            error, found = result["error_estimate"]["final"][0], result["final"]["x"][0]
            # Without switch detection errors depend on where in its step a switch is.
            factor = 3 if method != "timestepping" else 100
            self.assertLess(abs(found - exact[0]), factor * error, method)
            self.assertLess(error, factor * abs(found - exact[0]), method)

    def test_keys_in_order(self):
        self.assertEqual(list(self.result), KEYS)
        self.assertEqual(list(self.result["model"])[:3], ["name", "sha256", "parameters"])
        self.assertEqual(list(self.result["status"]), ["termination", "message", "time_reached"])
        self.assertEqual(list(self.result["final"]), ["t", "x", "mode", "alpha", "outputs"])
        self.assertEqual(list(self.result["trajectory"]), ["t", "x", "u", "alpha", "mode", "outputs"])
        self.assertEqual(list(self.result["statistics"]), ["steps", "rejected", "rhs_evaluations", "wall_seconds", "integrators"])
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
        self.assertEqual(result["options"]["simulate.event.integrator"], "auto")
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
        self.assertEqual(rows[0], ["t", "side", "q", "v", "alpha(slip)", "mode(slip)"])
        trajectory = self.result["trajectory"]
        self.assertEqual(len(rows) - 1, len(trajectory["t"]))
        for row, t, x in zip(rows[1:], trajectory["t"], trajectory["x"]):
            self.assertEqual([float(field) for field in [row[0], *row[2:4]]], [t, *x])
        behind = [float(row[0]) for row in rows[1:] if row[1] == "1"]
        self.assertEqual(behind, [event["t"] for event in self.result["events"]])

    def test_csv_has_the_outputs(self):
        out = self.csv("sliding-mode-pendulum", "--out", "r.csv", "--out", "r.json")
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        columns = range(2 + len(result["states"]), 2 + len(result["states"]) + len(result["outputs"]))
        self.assertEqual([out[0][k] for k in columns], result["outputs"])
        self.assertEqual([[float(row[k]) for k in columns] for row in out[1:]], result["trajectory"]["outputs"])

    def test_events_as_a_table(self):
        head, *rows = self.csv("stick-slip", "--out", "r.events.csv")
        self.assertEqual(head, ["t", "kind", "name", "surfaces", "q", "v", "after(q)", "after(v)", "mode_before(slip)",
                                "mode_after(slip)", "alpha_before(slip)", "alpha_after(slip)", "unique", "reason"])
        self.assertEqual(len(rows), len(self.result["events"]))
        for row, event in zip(rows, self.result["events"]):
            self.assertEqual((float(row[0]), row[1], row[3]), (event["t"], event["kind"], "slip"))
            self.assertEqual([float(field) for field in row[4:8]], event["x"] + event["x_after"])

    def csv(self, model, *arguments):
        self.run_tool("simulate", model, "--quiet", *arguments, code=0)
        with open(self.folder / arguments[1], newline="", encoding="utf-8") as file:
            return list(csv.reader(file))

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
        r, s = (timeless((self.folder / name).read_text(encoding="utf-8")) for name in ("r.json", "s.json"))
        self.assertEqual(r, s)

    def test_the_date_of_a_run(self):
        begin = datetime.datetime.now(datetime.timezone.utc).replace(microsecond=0)
        self.run_tool("simulate", "stick-slip", "--out", "s.json", "--quiet", code=0)
        stored = json.loads((self.folder / "s.json").read_text(encoding="utf-8"))
        date = datetime.datetime.strptime(stored["date"], "%Y-%m-%dT%H:%M:%S%z")
        self.assertTrue(begin <= date <= datetime.datetime.now(datetime.timezone.utc))
        self.run_tool("simulate", "stick-slip", "--out", "old.json", "--quiet", code=0,
                      environment={"SOURCE_DATE_EPOCH": "1700000000"})
        self.assertIn('"date": "2023-11-14T22:13:20Z"', (self.folder / "old.json").read_text(encoding="utf-8"))
        self.assertIn("the same", self.run_tool("diff", "s.json", "old.json", code=0)[0])
        self.run_tool("report", "old.json", code=0)
        self.assertIn("2023-11-14T22:13:20Z", (self.folder / "old.html").read_text(encoding="utf-8"))

    def test_what_was_edited_by_hand_is_refused(self):
        def edit(*path, value):
            result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
            *parents, last = path
            place = result
            for key in parents:
                place = place[key]
            self.assertNotEqual(place[last], value)
            place[last] = value
            self.write("edited.json", json.dumps(result))
        for path, value in ((("model", "initial_state", "q"), 0.25), (("model", "parameters", "belt"), 0.25),
                            (("model", "set"), ["belt=0.3"]), (("final", "x"), [1.0, 2.0]),
                            (("options", "simulate.rtol"), 1e-3), (("status", "time_reached"), 3.0)):
            edit(*path, value=value)
            for command in (["simulate", "edited.json"], ["diff", "r.json", "edited.json"], ["report", "edited.json"]):
                with self.subTest(path=path, command=command[0]):
                    self.assertIn("this result was edited", self.run_tool(*command, code=2)[1])

    def test_another_layout_of_the_same_numbers_is_no_edit(self):
        self.write("sorted.json", json.dumps(self.result, sort_keys=True, indent=7))
        self.assertIn("the same", self.run_tool("diff", "r.json", "sorted.json", code=0)[0])
        del self.result["record_sha256"]  # as of earlier versions
        self.result["model"]["initial_state"]["q"] = 0.25
        self.write("earlier.json", json.dumps(self.result))
        self.run_tool("diff", "r.json", "earlier.json", code=0)


def npy(data):
    """One array as numpy.load reads it (NEP 1): without NumPy, which is not needed to test Saltus."""
    assert data[:8] == b"\x93NUMPY\x01\x00"
    length = struct.unpack("<H", data[8:10])[0]
    assert (10 + length) % 64 == 0
    head = ast.literal_eval(data[10:10 + length].decode("ascii"))
    assert head["fortran_order"] is False
    body, (count,), kind = data[10 + length:], head["shape"], head["descr"]
    if kind.startswith("<U"):
        width = 4 * int(kind[2:])
        assert len(body) == width * count
        return [body[k * width:(k + 1) * width].decode("utf-32-le").rstrip("\0") for k in range(count)]
    return list(struct.unpack(f"<{count}{ {'<f8': 'd', '|i1': 'b'}[kind]}", body))


class Arrays(tool.ToolTest):
    def arrays(self, *arguments):
        self.run_tool("simulate", *arguments, "--out", "r.json", "--out", "r.npz", "--quiet", code=0)
        self.result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        with zipfile.ZipFile(self.folder / "r.npz") as archive:
            self.assertIsNone(archive.testzip())
            self.assertTrue(all(info.compress_type == zipfile.ZIP_DEFLATED for info in archive.infolist()))
            return {info.filename.removesuffix(".npy"): npy(archive.read(info)) for info in archive.infolist()}

    def test_all_columns_with_the_same_bits(self):
        arrays = self.arrays("sliding-mode-pendulum")
        trajectory, events = self.result["trajectory"], self.result["events"]
        self.assertEqual(arrays["t"], trajectory["t"])
        self.assertEqual(sum(arrays["side"]), len(events))
        for names, rows in (("states", "x"), ("controls", "u"), ("outputs", "outputs")):
            for i, name in enumerate(self.result[names]):
                self.assertEqual(arrays[name], [row[i] for row in trajectory[rows]])
        for i, name in enumerate(self.result["switching_functions"]):
            self.assertEqual(arrays[f"mode({name})"], [row[i] for row in trajectory["mode"]])
            self.assertEqual(arrays[f"alpha({name})"], [row[i] for row in trajectory["alpha"]])
            self.assertEqual(arrays[f"events.alpha_after({name})"], [event["alpha_after"][i] for event in events])
        self.assertEqual(arrays["events.t"], [event["t"] for event in events])
        self.assertEqual(arrays["events.kind"], [event["kind"] for event in events])
        self.assertEqual(arrays["events.reason"], [event["reason"] for event in events])
        for i, name in enumerate(self.result["states"]):
            self.assertEqual(arrays[f"events.after({name})"], [event["x_after"][i] for event in events])

    def test_events_have_the_impulses(self):
        for model, columns in ((contacts_test.BALL, ["impulse(ground)", "impulse(ground)[1]"]),
                               (contacts_test.SPACE, ["impulse(ground)", "impulse(ground)[1]", "impulse(ground)[2]"])):
            arrays = self.arrays(self.write("m.toml", model), "--out", "r.events.csv")
            impact, stick = self.result["events"]
            with open(self.folder / "r.events.csv", newline="", encoding="utf-8") as file:
                first, second = csv.DictReader(file)
            self.assertEqual([name for name in first if name.startswith("impulse")], columns)
            self.assertEqual([float(first[name]) for name in columns], impact["impulse"][0])
            self.assertEqual([arrays[f"events.{name}"][0] for name in columns], impact["impulse"][0])
            self.assertNotIn("impulse", stick)
            for name in columns:
                self.assertEqual(second[name], "")
                self.assertTrue(math.isnan(arrays[f"events.{name}"][1]))

    def test_branches_are_told_by_their_labels(self):
        arrays = self.arrays("spontaneous-switch", "--branch", "all")
        self.assertEqual(set(arrays["branch"]), {"main", "1", "2"})
        self.assertEqual(len(arrays["branch"]), len(arrays["x"]))
        self.assertTrue(all(mode != mode for mode in arrays["events.mode_before(x)"]))  # NaN: they begin with a start

    def test_numpy_reads_it(self):
        try:
            import numpy
        except ImportError:
            self.skipTest("there is no NumPy")
        self.arrays("stick-slip")
        with numpy.load(self.folder / "r.npz") as arrays:
            self.assertEqual(arrays["t"].tolist(), self.result["trajectory"]["t"])
            self.assertEqual(arrays["events.kind"].tolist(), [event["kind"] for event in self.result["events"]])


class StandardOutput(tool.ToolTest):
    def test_has_the_result_and_nothing_else(self):
        self.run_tool("simulate", "crossing", "--out", "r.json", "--out", "r.csv", "--out", "r.events.csv", "--quiet",
                      code=0)
        for format_, file in ((None, "r.json"), ("json", "r.json"), ("csv", "r.csv"), ("events.csv", "r.events.csv")):
            arguments = ["--format", format_] if format_ else []
            out, err = self.run_tool("simulate", "crossing", "--out", "-", *arguments, code=0)
            self.assertEqual(err, "")
            self.assertEqual(timeless(out), timeless((self.folder / file).read_text(encoding="utf-8")), format_)

    def test_formats_that_say_nothing(self):
        for arguments, message in ((["--format", "csv"], "it is for --out -"),
                                   (["--out", "-", "--format", "xls"], "expected json or csv or npz or events.csv"),
                                   (["--out", "-", "--out", "-"], "standard output is named twice")):
            err = self.run_tool("simulate", "crossing", *arguments, code=2)[1]
            self.assertIn(message, err)


class RegularGrid(tool.ToolTest):
    MODEL = """
[model]
name = "bounces"
[states]
h = 1
v = 0
[dynamics]
h = "v"
v = "-9.81"
[[jumps]]
when = "h"
direction = "down"
set = { v = "-0.8*v" }
[simulate]
until = 2
"""

    def times(self, *arguments, model=None):
        self.write("m.toml", model or self.MODEL)
        self.run_tool("simulate", "m.toml", "--out", "r.json", "--quiet", *arguments, code=0)
        self.result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        return self.result["trajectory"]["t"]

    def test_no_rows_at_events(self):
        with_events = self.times("--set", "simulate.output.every=0.01")
        final, events = self.result["final"], self.result["events"]
        self.assertEqual(len(with_events), 201 + 2 * len(events))
        times = self.times("--set", "simulate.output.every=0.01", "--set", "simulate.output.events=false")
        self.assertEqual(len(times), 201)
        self.assertTrue(all(abs(t - 0.01 * k) < 1e-12 for k, t in enumerate(times)))
        self.assertEqual((self.result["final"], self.result["events"]), (final, events))
        times = self.times(model=self.MODEL + "output = { points = 11, events = false }\n")
        self.assertEqual(len(times), 11)
        self.run_tool("report", "r.json", code=0)

    def test_steps_without_doubled_rows(self):
        times = self.times(model=self.MODEL + "output = { events = false }\n")
        self.assertEqual(times, sorted(set(times)))
        for event in self.result["events"]:  # the row behind it is left
            row = times.index(event["t"])
            self.assertEqual(self.result["trajectory"]["x"][row], event["x_after"])

    def test_the_end_is_a_row_where_an_event_stops(self):
        times = self.times(model=self.MODEL + 'output = { every = 0.5, events = false }\n'
                                              '[[events]]\nwhen = "h - 0.1"\nstop = true\n')
        self.assertEqual(times[:-1], [0.0])
        self.assertEqual(times[-1], self.result["final"]["t"])

    def test_what_is_no_truth_is_refused(self):
        self.write("m.toml", self.MODEL + "output = { every = 1, events = 0 }\n")
        err = self.run_tool("simulate", "m.toml", code=2)[1]
        self.assertIn("m.toml:16:", err)
        self.assertIn("expected true or false, found 0", err)


class Branches(tool.ToolTest):
    def test_are_results_of_the_same_form(self):
        out, _ = self.run_tool("simulate", "spontaneous-switch", "--branch", "all", "--out", "r.json", "--out", "r.csv",
                               code=0)
        self.assertIn("branches    2\n", out)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertEqual(list(result), [*OF_ONE_STATE, "branches"])
        self.assertEqual(result["options"]["simulate.event.branches"], 64)
        ends = [result["final"]["x"][0]]
        for branch in result["branches"]:
            # To stay at 0 is to be able to leave at any later time.
            stays = branch["events"][0]["mode_after"] == [0]
            self.assertEqual(list(branch), [*OF_ONE_STATE, *(["families"] if stays else []), "left_at"])
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
        self.assertRegex(out, r"families    2, after event 1: may leave into - at any time from 0 to 1\n")
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

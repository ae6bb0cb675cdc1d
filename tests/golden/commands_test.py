"""The small commands: diff, new, cite."""

import bisect
import json
import re

import tool


class SmallWords(tool.ToolTest):
    def test_a_date_that_is_none_is_told(self):
        err = self.run_tool("simulate", "stick-slip", "--out", "r.json", code=0, environment={"SOURCE_DATE_EPOCH": "abc"})[1]
        self.assertIn("SOURCE_DATE_EPOCH = 'abc'", err)
        err = self.run_tool("simulate", "stick-slip", "--out", "r.json", code=0, environment={"SOURCE_DATE_EPOCH": "5"})[1]
        self.assertNotIn("SOURCE_DATE_EPOCH", err)

    def test_of_no_events_shown_there_is_no_table(self):
        text = self.run_tool("simulate", "stick-slip", "--events", "0", code=0)[0]
        self.assertRegex(text, r"(?m)^events +9$")
        self.assertNotIn("the first and the last", text)
        self.assertNotIn("surfaces", text)


class Diff(tool.ToolTest):
    def run_model(self, name, model, *arguments):
        self.run_tool("simulate", model, *arguments, "--out", name, "--quiet", code=0)
        return name

    def test_two_runs_of_one_accuracy_are_the_same(self):
        a = self.run_model("a.json", "stick-slip")
        b = self.run_model("b.json", "stick-slip", "--rtol", "1e-10", "--integrator", "dop853")
        out, err = self.run_tool("diff", a, b, code=0)
        self.assertEqual(err, "")
        self.assertTrue(out.startswith("the same to rtol 1e-06, atol 1e-06 of each range ("), out)
        self.run_tool("diff", a, b, "--rtol", "0", "--atol", "0", code=1)
        self.assertTrue(self.run_tool("diff", a, a, "--rtol", "0", "--atol", "0", code=0)[0].startswith("the same"))

    def test_says_what_differs(self):
        a = self.run_model("a.json", "stick-slip")
        b = self.run_model("b.json", "stick-slip", "--set", "belt=0.3")
        out, err = self.run_tool("diff", a, b, code=1)
        self.assertEqual(err, "")
        self.assertRegex(out, r"(?m)^parameters\n  belt +0.2 +0.3 ")
        self.assertRegex(out, r"(?m)^first event that differs: event 1: ")
        self.assertRegex(out, r"(?m)^different to rtol")

    def test_what_differs_between_the_ends_is_seen(self):
        self.write("wave.toml", "[model]\nname = \"wave\"\n[parameters]\na = 1\n[states]\nx = 1\n[dynamics]\nx = \"a*cos(t)\"\n"
                                "[simulate]\nuntil = 6.283185307179586\n")
        a = self.run_model("a.json", "wave.toml")
        b = self.run_model("b.json", "wave.toml", "--set", "a=3")
        self.assertRegex(self.run_tool("diff", a, b, code=1)[0], r"(?m)^on the way\n  x at t = ")
        close = self.run_model("close.json", "wave.toml", "--rtol", "1e-11", "--integrator", "dop853")
        self.assertRegex(self.run_tool("diff", a, close, code=0)[0], r"[1-9]\d* between rows")
        slip = self.run_model("slip.json", "bouncing-ball", "--set", "simulate.output=auto")
        again = self.run_model("again.json", "bouncing-ball", "--set", "simulate.output=auto", "--integrator", "taylor")
        self.run_tool("diff", slip, again, code=0)

    def test_the_largest_difference_on_the_way_is_told(self):
        a = self.run_model("a.json", "bouncing-ball")
        b = self.run_model("b.json", "bouncing-ball", "--set", "v=1")
        text = self.run_tool("diff", a, b, code=1)[0]
        found = float(re.search(r"(?m)^on the way\n  y at t = .* difference (\S+)$", text)[1])
        first, second = (json.loads((self.folder / name).read_text(encoding="utf-8"))["trajectory"] for name in (a, b))

        def line(rows, t):
            """Between two rows; None at jumps."""
            place = bisect.bisect_left(rows["t"], t)
            if not 0 < place < len(rows["t"]) or rows["t"][place] == t:
                return None
            begin, end = rows["t"][place - 1], rows["t"][place]
            return ((end - t) * rows["x"][place - 1][0] + (t - begin) * rows["x"][place][0]) / (end - begin)

        apart = [abs(line(other, t) - x[0]) for rows, other in ((first, second), (second, first))
                 for t, x in zip(rows["t"], rows["x"]) if line(other, t) is not None]
        self.assertGreater(abs(found), 0.95 * max(apart))

    def test_lines_between_thinned_rows_say_nothing(self):
        self.write("wave.toml", "[model]\nname = \"wave\"\n[states]\nx = 1\n[dynamics]\nx = \"cos(t)\"\n[simulate]\nuntil = 6\n")
        whole, b = self.run_model("a.json", "wave.toml"), self.run_model("b.json", "wave.toml", "--rtol", "1e-11")
        result = json.loads((self.folder / whole).read_text(encoding="utf-8"))
        rows = result["trajectory"]
        for key, values in rows.items():
            rows[key] = [*values[:10], *values[10:-1:10], values[-1]]
        self.write("few.json", json.dumps(result))
        self.run_tool("diff", "few.json", b, code=1)
        result["statistics"]["thinned_from"] = rows["t"][9]
        self.write("few.json", json.dumps(result))
        self.run_tool("diff", "few.json", b, code=0)

    def test_results_of_other_equations_are_refused(self):
        a = self.run_model("a.json", "stick-slip")
        b = self.run_model("b.json", "stick-slip", "--set", "dynamics.q=2*v")
        for command, first, second in (("diff", a, b), ("report", b, a)):
            self.assertIn("q' = v and q' = 2*v", self.run_tool(command, first, second, code=2)[1])

    def test_values_near_zero_are_compared_with_their_range(self):
        self.write("m.toml", "[model]\nname = \"m\"\n[states]\nx = 1\nv = 0\nsmall = 1e-7\n[dynamics]\nx = \"v\"\nv = \"-x\"\n"
                             "small = \"-small\"\n[simulate]\nuntil = 1.5707963267948966\natol = 1e-14\n")
        a = self.run_model("a.json", "m.toml")
        changed = json.loads((self.folder / a).read_text(encoding="utf-8"))
        del changed["record_sha256"]

        def differs(state, by, *words, code):
            other = json.loads(json.dumps(changed))
            other["final"]["x"][state] += by
            self.write("b.json", json.dumps(other))
            return self.run_tool("diff", a, "b.json", *words, code=code)[0]

        # x ends at 0 and has been 1: what is 1e-7 there is no difference. The third state is that small everywhere.
        differs(0, 1e-7, code=0)
        differs(0, 1e-7, "--atol", "1e-9", code=1)
        differs(0, 3e-6, code=1)
        self.assertIn("small ", differs(2, 1e-12, code=1))

    def test_an_event_that_differs_alone_is_seen(self):
        a = self.run_model("a.json", "bouncing-ball")
        changed = json.loads((self.folder / a).read_text(encoding="utf-8"))
        changed["events"][1]["t"] += 1e-3
        self.write("b.json", json.dumps(changed))
        self.assertIn("event 2: jump", self.run_tool("diff", a, "b.json", code=1)[0])
        changed["events"][1]["t"] -= 1e-3
        del changed["events"][-1]
        self.write("b.json", json.dumps(changed))
        self.assertIn("numbers of events: ", self.run_tool("diff", a, "b.json", code=1)[0])

    def test_different_models_and_files_that_are_none(self):
        a = self.run_model("a.json", "stick-slip")
        b = self.run_model("b.json", "two-belts")
        out, err = self.run_tool("diff", a, b, code=2)
        self.assertEqual(out, "")
        self.assertIn("different models", err)
        self.write("c.json", "{}")
        self.assertIn("c.json", self.run_tool("diff", a, "c.json", code=2)[1])
        self.assertIn("none.json", self.run_tool("diff", "none.json", a, code=2)[1])
        for wrong in ("-1", "nan", "x"):
            err = self.run_tool("diff", a, a, "--rtol", wrong, code=2)[1]
            self.assertIn("--rtol", err)
            self.assertIn("not negative", err)
            self.assertLess(len(err), 200)


class New(tool.ToolTest):
    def test_every_kind_runs_without_a_warning(self):
        for kind in ("relay", "gene", "friction", "impact"):
            out, _ = self.run_tool("new", f"my-{kind}", "--like", kind, code=0)
            self.assertIn(f"saltus simulate my-{kind}.toml", out)
            text = (self.folder / f"my-{kind}.toml").read_text(encoding="utf-8")
            self.assertIn(f'name = "my-{kind}"', text)
            self.assertTrue(text.startswith("#:schema "))
            out, err = self.run_tool("simulate", f"my-{kind}.toml", code=0)
            self.assertEqual(err, "")
            if kind == "friction":
                self.assertRegex(out, r"(?m)^end state +x = [-0-9.e]+ m  v = 0 m/s$")
            self.assertGreater(int(re.search(r"(?m)^events +(\d+)", out).group(1)), 0)

    def test_what_is_there_stays(self):
        self.write("m.toml", "mine")
        for name in ("m", "m.toml"):
            self.assertIn("this file exists", self.run_tool("new", name, code=2)[1])
        self.assertEqual((self.folder / "m.toml").read_text(encoding="utf-8"), "mine")

    def test_bad_input(self):
        self.assertIn("did you mean 'relay'?", self.run_tool("new", "m", "--like", "relai", code=2)[1])
        self.assertIn("cannot name a model", self.run_tool("new", 'a"b', code=2)[1])
        self.assertIn("NAME", self.run_tool("new", code=2)[1])
        self.assertIn("there is no folder 'no/such'", self.run_tool("new", "no/such/folder", code=2)[1])

    def test_the_commands_it_names_can_be_typed_and_the_schema_is_there(self):
        out, _ = self.run_tool("new", "a b", code=0)
        self.assertIn("next: saltus check 'a b.toml'\n", out)
        self.assertIn("saltus simulate 'a b.toml' --report 'a b.html'\n", out)
        self.assertIn("saltus.schema.json", out)
        schema = self.folder / "saltus.schema.json"
        self.assertIn("properties", json.loads(schema.read_text(encoding="utf-8")))
        schema.write_text("{}", encoding="utf-8")
        self.assertNotIn("saltus.schema.json", self.run_tool("new", "c", code=0)[0])
        self.assertEqual(schema.read_text(encoding="utf-8"), "{}")


DRIVEN = """[model]
name = "driven"
[states]
x = 1
[controls]
u = 0
[dynamics]
x = "u - sign(x)"
[simulate]
until = 1
output = { points = 5 }
inputs = { u = 0.5 }
"""


class TablesAreSet(tool.ToolTest):
    def rows(self, *settings):
        arguments = [word for setting in settings for word in ("--set", setting)]
        self.run_tool("simulate", self.write("m.toml", DRIVEN), *arguments, "--out", "r.json", "--quiet", code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def test_as_in_a_file(self):
        def times(result):
            return len(result["trajectory"]["t"])
        self.assertEqual(times(self.rows("simulate.output={ points = 11, events = false }")), 11)
        self.assertEqual(times(self.rows("simulate.output={every=0.25,events=false}")), 5)
        result = self.rows('simulate.event={ integrator = "dop853", max_step = 0.5 }', "simulate.initial_mode={ x = 1 }")
        self.assertEqual(result["options"]["simulate.event.integrator"], "dop853")
        self.assertEqual(result["options"]["simulate.event.max_step"], 0.5)
        self.assertEqual(times(result), times(self.rows("simulate.initial_mode.x=1")))
        for setting in ('simulate.inputs={ u = "-t" }', 'simulate.inputs.u={ file = "u.csv" }'):
            self.write("u.csv", "t,u\n0,0\n1,-1\n")
            self.assertNotEqual(self.rows(setting)["final"]["x"], self.rows()["final"]["x"])
        self.run_tool("simulate", "r.json", "--out", "again.json", code=0)  # the setting is stored
        again = json.loads((self.folder / "again.json").read_text(encoding="utf-8"))
        self.assertEqual(again["final"], json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["final"])

    def test_of_an_optimisation(self):
        self.run_tool("optimize", tool.SOURCE / "examples/optimize/block.toml", "--quiet", "--out", "r.json", "--set",
                      "optimize.mpcc={ tolerance = 1e-7 }", "--set",
                      "optimize.horizon={ free = true, initial = 1.5, lower = 1, upper = 2 }", code=0)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertEqual(result["options"]["optimize.mpcc.tolerance"], 1e-7)
        self.assertAlmostEqual(result["horizon"], 1.46647, places=4)

    def test_mistakes_are_told(self):
        self.write("m.toml", DRIVEN)
        for settings, told in ((["simulate.output={ points = 11, every = 0.1 }"], "`points` and `every` of output say twice"),
                               (["simulate.output.points=11", "simulate.output.every=0.1"], "say twice when there are rows"),
                               (["simulate.output={ point = 11 }"], "did you mean 'simulate.output.points'"),
                               (["simulate.output={ points = 1 }"], "a whole number from 2"),
                               (["simulate.output={}"], "the table output is empty"),
                               (["simulate.event={ integrator = taylor }"], "words in quotes"),
                               (["simulate.output=foo"], "states = [names]"),
                               (["optimize.mpcc={ tolerance = 1e-7 }"], "no table [optimize]")):
            arguments = [word for setting in settings for word in ("--set", setting)]
            err = self.run_tool("simulate", "m.toml", *arguments, code=2)[1]
            self.assertIn(told, err)
            self.assertTrue(err.startswith(f"--set {settings[0].partition('=')[0]}: error: ") or len(settings) > 1, err)


class Words(tool.ToolTest):
    def test_help_is_a_command(self):
        self.assertEqual(self.run_tool("help", "help", code=0), self.run_tool("help", code=0))
        self.assertIn("did you mean 'help'?", self.run_tool("hlep", code=2)[1])

    def test_words_in_the_wrong_place_are_answered(self):
        self.write("brake.toml", "")
        self.write("rows.csv", "t,x\n0,1\n")
        for arguments, told in ((["brake.toml"], "did you mean `saltus simulate brake.toml`?"),
                                (["stick-slip"], "did you mean `saltus simulate stick-slip`?"),
                                (["simulate", "brak.toml"], "did you mean 'brake.toml'?"),
                                (["simulate", "rows.csv"], "this is a table of numbers, no model of Saltus\n  a model is a .toml file"),
                                (["simulate", "stick"], "did you mean 'stick-slip'"),
                                (["simulate", "stick-slip", "--figure", "x.svg"], "--figure is an option of `saltus report`: add --out r.json, then "
                                 "saltus report r.json --figure"),
                                (["sweep", "stick-slip", "--figure", "x.svg"], "--figure is an option of `saltus report`; saltus sweep draws its "
                                 "table with --report FILE.html\n"),
                                (["report", "rows.csv", "--figure", "x.svg"], "rows.csv: error: a .csv file is a table, not the whole result\n"),
                                (["diff", "rows.csv", "rows.csv"], "a sweep draws its table with --report FILE.html"),
                                (["new", "ring", "--like", "repressilator"], "saltus models repressilator > ring.toml\n"),
                                (["new", "ring", "--like", "genes"], "did you mean 'gene'?"),
                                (["check", "stick-slip", "--until", "3"], "--until is an option of `saltus simulate`"),
                                (["simulate", "stick-slip", "--output", "x.json"], "did you mean '--out'?"),
                                (["simulate", "stick-slip", "--show", "w"], "known: q, v, slip\n")):
            self.assertIn(told, self.run_tool(*arguments, code=2)[1])

    def test_an_unknown_suffix_is_answered_with_all_that_there_are(self):
        err = self.run_tool("simulate", "stick-slip", "--out", "bb.xyz", code=2)[1]
        self.assertIn(".json or .csv or .events.csv or .npz", err)


class Cite(tool.ToolTest):
    def test_says_what_citation_cff_says(self):
        text, _ = self.run_tool("cite", code=0)
        cff = (tool.SOURCE / "CITATION.cff").read_text(encoding="utf-8")
        self.assertIn(re.search(r'(?m)^title: "(.*)"$', cff).group(1), text)
        self.assertIn(re.search(r"(?m)^version: (.*)$", cff).group(1), text)
        self.assertEqual(text.count("{"), text.count("}"))

    def keys(self, *arguments):
        text, _ = self.run_tool("cite", *arguments, code=0)
        self.assertEqual(text.count("{"), text.count("}"))
        return re.findall(r"(?m)^@\w+\{\s*([\w]+),", text)

    def test_names_the_papers_of_what_a_model_is_run_with(self):
        self.assertEqual(self.keys(), ["saltus", "guglielmi2022", "nurkanovic2024"])
        self.assertEqual(self.keys("stick-slip"), ["saltus", "guglielmi2022", "hairer1993", "filippov1988"])
        optimal = self.keys("turbo-car")
        for key in ("nurkanovic2024", "scholtes2001", "waechter2006"):
            self.assertIn(key, optimal)
        bibliography = (tool.SOURCE / "docs/references.bib").read_text(encoding="utf-8")
        for key in optimal[1:]:
            self.assertIn(f"{{{key},", bibliography)
        self.run_tool("simulate", "stick-slip", "--integrator", "radau5", "--out", "r.json", "--quiet", code=0)
        self.assertIn("hairer1996", self.keys("r.json"))
        self.assertIn("did you mean", self.run_tool("cite", "stick-slipp", code=2)[1])


if __name__ == "__main__":
    tool.main()

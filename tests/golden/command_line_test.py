"""Exit codes, help, tables and messages of the command line."""

import json
import math
import re
import subprocess

import tool

MODEL = """
[model]
name = "slow-down"
description = "two speeds"
[parameters]
fast = 3
[controls]
u = 0
[states]
x = -1
[dynamics]
x = "if(x > 0, 1, fast) + u"
[simulate]
until = 1.0
"""


class Help(tool.ToolTest):
    def test_help_and_version_are_no_errors(self):
        self.assertIn("simulate", self.run_tool("--help", code=0)[0])
        self.assertRegex(self.run_tool("--version", code=0)[0], r"^saltus \d+\.\d+\.\d+\n$")

    def test_help_names_what_is_there_and_nothing_else(self):
        text, _ = self.run_tool("--help", code=0)
        self.assertIn("optimize", text)
        self.assertNotIn("options-page", text)

    def test_every_subcommand_ends_with_one_example(self):
        for command in ("simulate", "compare", "order", "check", "mpcc", "report", "models", "diff", "new", "cite"):
            text, _ = self.run_tool(command, "--help", code=0)
            lines = text.rstrip().splitlines()
            self.assertEqual(lines[-2], "Example:", text)
            self.assertTrue(lines[-1].startswith(f"  saltus "), text)
            self.assertIn(f"saltus {command}", lines[-1])

    def test_help_of_a_command(self):
        for command in ("simulate", "diff", "check"):
            self.assertEqual(self.run_tool("help", command, code=0), self.run_tool(command, "--help", code=0))
        self.assertEqual(self.run_tool("help", code=0), self.run_tool("--help", code=0))
        self.assertIn("did you mean 'simulate'?", self.run_tool("help", "simulat", code=2)[1])

    def test_examples_run(self):
        for command in ("check", "compare", "models", "order", "simulate"):
            text, _ = self.run_tool(command, "--help", code=0)
            example = text.rstrip().splitlines()[-1].split(">")[0].split()
            self.run_tool(*example[1:], code=0)

    def test_help_of_simulate_is_short_and_all_of_it_lists_the_options_table(self):
        short, _ = self.run_tool("simulate", "--help", code=0)
        self.assertLess(len(short.splitlines()), 40)
        text, _ = self.run_tool("simulate", "--help-all", code=0)
        self.assertTrue(text.startswith(short.rstrip()), text)
        self.assertLessEqual(max(map(len, text.splitlines())), 120)
        for key in ("event.integrator", "output.every", "initial_mode.*", "max_steps", "default 1e-08"):
            self.assertIn(key, text)

    def test_the_page_of_options_is_up_to_date(self):
        page, _ = self.run_tool("options-page", code=0)
        self.assertEqual(page, (tool.SOURCE / "docs/options.md").read_text(encoding="utf-8"))


class End(tool.ToolTest):
    def test_the_last_of_given_times_is_the_end_where_none_is_stated(self):
        model = self.write("m.toml", MODEL.partition("[simulate]")[0])
        rows = ["--set", "simulate.output.times=[0, 0.25, 0.5]"]
        for method in ("event", "smoothed", "fesd"):
            with self.subTest(method):
                self.run_tool("simulate", model, *rows, "--method", method, "--error-estimate", "--out", "r.json", code=0)
                result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
                self.assertEqual(result["status"]["time_reached"], 0.5)
                self.assertEqual(result["trajectory"]["t"], [0, 0.25, 0.5])
        self.run_tool("simulate", "r.json", "--out", "again.json", code=0)  # a stored result has it, too
        self.run_tool("check", model, *rows, code=0)
        self.assertIn("t = 0.5", self.run_tool("compare", model, *rows, code=0)[0])
        self.run_tool("sweep", model, *rows, "--over", "fast=1,2", "--keep", "trajectory", "--out", "s.csv", code=0)
        self.assertEqual(len((self.folder / "s.csv").read_text(encoding="utf-8").splitlines()), 7)

    def test_a_stated_end_holds(self):
        model = self.write("m.toml", MODEL)
        out, _ = self.run_tool("simulate", model, "--set", "simulate.output.times=[0, 0.5]", code=0)
        self.assertIn("completed at t = 1", out)
        _, message = self.run_tool("simulate", model, "--set", "simulate.output.times=[0, 2]", code=2)
        self.assertIn("output time 2 lies outside the simulation from 0 to 1", message)
        _, message = self.run_tool("simulate", model, "--set", "simulate.from=3", "--until", "2", code=2)
        self.assertIn("until (2) is not after from (3)", message)


class BadInput(tool.ToolTest):
    def refused(self, expected, *arguments):
        out, err = self.run_tool(*arguments, code=2)
        self.assertIn(expected, err)
        self.assertEqual(out, "")

    def test_command_line(self):
        self.refused("simulate", )
        self.refused("did you mean 'simulate'?", "simulat", "crossing")
        self.refused("MODEL", "simulate")
        self.refused("unexpected argument '--rtoll'", "simulate", "crossing", "--rtoll", "1")
        self.refused("did you mean '--rtol'", "simulate", "crossing", "--rtoll", "1")
        self.refused("unexpected argument 'again'", "simulate", "crossing", "again")
        self.refused("--until abc: error: expected a finite number", "simulate", "crossing", "--until", "abc")
        self.refused("--rtol -1", "simulate", "crossing", "--rtol", "-1")
        self.refused("until (0) is not after from (0)", "simulate", "crossing", "--until", "0")
        self.refused("--rtol", "simulate", "crossing", "--rtol")

    def test_later_commands_and_methods(self):
        self.refused("radau_iia has 1 to 9 stages, not 10", "simulate", "crossing", "--method", "fesd", "--set", "simulate.fesd.stages=10")
        self.refused("at least 2 elements", "simulate", "crossing", "--method", "fesd", "--set",
                     "simulate.fesd.elements=1")
        self.refused("initial_mode has no meaning", "simulate", "spontaneous-switch", "--method", "smoothed", "--set",
                     "simulate.initial_mode.x=1")
        self.refused("--set simulate.smoothed.epsilon: error: expected a finite number > 0, found 0", "simulate",
                     "crossing", "--set", "simulate.smoothed.epsilon=0")
        self.refused("did you mean 'smoothed'?", "simulate", "crossing", "--method", "smooth")
        for wrong in ("0", "some", "1.5"):
            self.refused('expected "report", "all" or a whole number >= 1', "simulate", "crossing", "--branch", wrong)

    def test_models(self):
        self.refused("did you mean 'crossing'?", "simulate", "crosing")
        self.refused("no such file", "simulate", "folder/none.toml")
        self.refused("this is a folder", "check", ".")
        self.refused("too large", "check", self.write("big.toml", "#" * (16 * 2**20 + 1)))

    def test_settings(self):
        model = self.write("m.toml", MODEL)
        self.refused("fast", "simulate", model, "--set", "fst=1")
        self.refused("expected NAME=VALUE", "simulate", model, "--set", "fast")
        self.refused("expected NAME=VALUE", "simulate", model, "--set", "fast=")
        self.refused("--set fast=1+:1:", "simulate", model, "--set", "fast=1+")
        self.refused("did you mean 'simulate.rtol'?", "simulate", model, "--set", "simulate.rtl=1")

    def test_outputs_are_checked_before_computing(self):
        model = self.write("m.toml", MODEL)
        self.refused("must end in .json or .csv", "simulate", model, "--out", "r.txt")
        self.refused("there is no folder", "simulate", model, "--out", "none/r.json")
        self.refused("named twice", "simulate", model, "--out", "r.json", "--out", "./r.json")
        self.refused("must end in .html", "simulate", model, "--report", "r.json")
        (self.folder / "d.json").mkdir()
        self.refused("this is a folder", "simulate", model, "--out", "good.json", "--out", "d.json")
        self.assertFalse((self.folder / "good.json").exists())

    def test_a_missing_plotly_is_told_before_computing(self):
        model = self.write("m.toml", MODEL)
        out, err = self.run_tool("simulate", model, "--report", "r.html", code=2,
                                 environment={"SALTUS_PLOTLY": "/none/plotly.min.js"})
        self.assertIn("SALTUS_PLOTLY", err)


class Simulate(tool.ToolTest):
    def test_smoothed(self):
        model = self.write("m.toml", MODEL + "[simulate.smoothed]\nepsilon = 1e-4\n")
        out, err = self.run_tool("simulate", model, "--method", "smoothed", code=0)
        self.assertEqual(err, "")
        self.assertRegex(out, r"(?m)^method +smoothed \(epsilon 0.0001, radau5, rtol 1e-08, atol 1e-10\)$")
        self.assertRegex(out, r"(?m)^ +1 .* enter_sliding .*\n +2 .* leave_sliding ")
        out, _ = self.run_tool("simulate", "entering-sliding", "--method", "smoothed", code=0)
        self.assertRegex(out, r"(?m)^in layer of +x \(alpha 0.5\)$")

    def test_table(self):
        out, err = self.run_tool("simulate", self.write("m.toml", MODEL), code=0)
        self.assertEqual(err, "")
        self.assertRegex(out, r"(?m)^model +slow-down: two speeds$")
        self.assertRegex(out, r"(?m)^method +event \(auto, rtol 1e-08, atol 1e-10\)$")
        self.assertRegex(out, r"(?m)^status +completed at t = 1$")
        self.assertRegex(out, r"(?m)^end state +x = 0\.6666666\d*$")
        self.assertRegex(out, r"(?m)^events +1$")
        self.assertRegex(out, r"(?m)^  # +t +kind +surfaces +mode$")
        self.assertRegex(out, r"(?m)^  1 +0\.3333333\d* +crossing +x +- > \+$")
        self.assertRegex(out, r"(?m)^statistics +\d+ steps, \d+ rejected, \d+ evaluations")
        self.assertLessEqual(max(map(len, out.splitlines())), 100)

    def test_quiet_prints_nothing(self):
        self.assertEqual(self.run_tool("simulate", self.write("m.toml", MODEL), "--quiet", code=0), ("", ""))

    def test_settings_change_parameters_states_controls_and_options(self):
        model = self.write("m.toml", MODEL)
        def end(*settings):
            out, _ = self.run_tool("simulate", model, *settings, code=0)
            return float(out.split("x = ")[1].split()[0])
        self.assertAlmostEqual(end("--set", "fast=2"), 0.5, 8)
        self.assertAlmostEqual(end("--set", "x=1/2"), 1.5, 8)
        self.assertAlmostEqual(end("--set", "u=1"), 1.5, 8)
        self.assertAlmostEqual(end("--set", "simulate.until=2"), 5 / 3, 8)
        self.assertAlmostEqual(end("--until", "2"), 5 / 3, 8)
        met = math.sqrt(11) - 3  # -1 + 3 t + t^2/2 = 0; then x' = 1 + t
        self.assertAlmostEqual(end("--set", "simulate.inputs.u=t"), (1 - met) + (1 - met**2) / 2, 6)
        self.assertAlmostEqual(end("--set", "dynamics.x=1"), 0.0, 8)
        self.assertAlmostEqual(end("--set", "fast=2", "--set", "x=-0.5", "--integrator", "dop853"), 0.75, 8)

    def test_an_early_stop_has_its_own_code_and_is_written(self):
        model = self.write("m.toml", MODEL)
        out, err = self.run_tool("simulate", model, "--set", "simulate.max_steps=1", "--set", "dynamics.x=-sin(x)*x",
                                 "--until", "1000", "--out", "r.json", code=3)
        self.assertIn("iteration_limit", out)
        self.assertIn("stopped early: iteration_limit", err)
        self.assertIn("what each status means, and what helps: docs/questions.md", err)
        self.assertTrue((self.folder / "r.json").exists())
        # In one stream the reason is said once.
        joined = subprocess.run([tool.TOOL, "simulate", model, "--set", "simulate.max_steps=1", "--until", "1000"], text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False).stdout
        self.assertEqual(joined.count("max_steps = 1"), 1, joined)

    def test_long_event_lists_show_both_ends_and_the_count(self):
        model = self.write("m.toml", """
[model]
name = "many"
[states]
x = 0.5
v = 0
[dynamics]
x = "v"
v = "-x"
[[events]]
name = "middle"
when = "x"
[simulate]
until = 100
""")
        out, _ = self.run_tool("simulate", model, code=0)
        self.assertRegex(out, r"(?m)^events +32, the first and the last 10$")
        rows = [line for line in out.splitlines() if " user " in line]
        self.assertEqual(len(rows), 20)
        self.assertTrue(rows[-1].split()[0] == "32" and rows[0].split()[0] == "1")
        for shown, count in (("3", 6), ("all", 32), ("0", 0), ("100", 32)):
            out, _ = self.run_tool("simulate", model, "--events", shown, code=0)
            self.assertEqual(len([line for line in out.splitlines() if " user " in line]), count, shown)
            self.assertRegex(out, r"(?m)^events +32")
        _, err = self.run_tool("simulate", model, "--events", "some", code=2)
        self.assertIn("expected a whole number or all", err)


class Check(tool.ToolTest):
    def test_says_what_a_model_is(self):
        model = self.write("m.toml", """
[model]
name = "m"
[parameters]
c = 2
unused = 1
[controls]
u = { initial = 0.5, lower = -1, upper = 1 }
[states]
x = 1
[switching]
a = "x - 1"
b = "2 - 2*x"
[dynamics]
x = "if(a > 0, 4, 1)*sign(x - 1) + step(b) + abs(x) + step(t - 1) + u*c"
[simulate]
until = 1
""")
        out, err = self.run_tool("check", model, code=0)
        for expected in ("x = 1", "c = 2", "u = 0.5  in [-1, 1]", "a: x - 1 = 0; x' may jump there", "x = 0; x' has a corner there", "time event: t - 1 = 0",
                         "b: alias of a, with the sides swapped", "differ in: x", "unused"):
            self.assertIn(expected, out)
        self.assertEqual(err, "")

    def test_says_how_large_the_complementarity_systems_are_and_whether_they_are_regular(self):
        out, _ = self.run_tool("check", "two-belts", "--well-posedness", code=0)
        numbers = {line.split()[0]: [int(n) for n in line.split()[1:]]
                   for line in out.splitlines() if line.startswith(("  step  ", "  stewart  "))}
        # alpha, theta, beta, n_alg, n_comp, n_eq of two functions and four fields: Table 4
        self.assertEqual(numbers, {"step": [2, 4, 0, 4 + 3 * 2, 2 * 2, 2 + 4],
                                   "stewart": [0, 4, 0, 2 * 4 + 1, 4, 4 + 1]})
        both = out.split("first, second = 0")[1].splitlines()
        self.assertRegex(both[1], r"step +rank 2 of 2, smallest singular value 0\.[0-9]+$")
        self.assertRegex(both[2], r"stewart +rank 4 of 5, .*singular")
        out, _ = self.run_tool("check", "two-belts", "--well-posedness", "--set", "simulate.max_events=1",
                               code=0)
        self.assertRegex(out, r"the simulation stopped at t = 0\.24")
        out, _ = self.run_tool("check", "bouncing-ball", "--well-posedness", code=0)
        self.assertIn("none: finite elements do not cover models with [[jumps]]", out)
        self.assertNotIn("well-posedness", out)

    def test_lists_the_columns_in_their_order_then_the_rest(self):
        model = self.write("m.toml", """
[model]
name = "m"
[switching]
second = "x - 2"
first = "1 - x"
[states]
x = 0
[dynamics]
x = "sign(max(x, 3) - 4) + step(x - 5) + sign(first) + step(x - 2) + step(t - 1)"
[simulate]
until = 1
""")
        out, _ = self.run_tool("check", model, code=0)
        # Without a name of its own a function is shown as "x - 5 = 0"; its column has the expression without spaces.
        heads = [line.partition(" = 0;")[0].strip() for line in out.split("switching functions")[1].splitlines()[1:]]
        names = [head.partition(":")[0] if head.startswith(("second", "first")) else head.rpartition(": ")[2].replace(" ", "") for head in heads]
        self.run_tool("simulate", model, "--out", "r.json", code=0)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        columns = result["switching_functions"]
        self.assertEqual(columns, ["second", "first", "max(x,3)-4", "x-5"])
        self.assertEqual(names[:len(columns)], columns)
        self.assertEqual(names[len(columns):len(columns) + 2], ["x-3", "t-1"])

    def test_takes_every_model_of_the_catalogue(self):
        listed, _ = self.run_tool("models", code=0)
        for line in listed.partition("\n\n")[0].splitlines():
            self.run_tool("check", line.split()[0], code=0)


class Models(tool.ToolTest):
    def test_lists_names_and_descriptions(self):
        out, _ = self.run_tool("models", code=0)
        self.assertRegex(out, r"(?m)^stick-slip +a block on a moving belt sticks and slips$")
        names = [line.split()[0] for line in out.partition("\n\n")[0].splitlines()]
        self.assertEqual(names, sorted(path.stem for path in (tool.SOURCE / "models").rglob("*.toml")))

    def test_the_catalogue_tells_of_every_model(self):
        rows = (tool.SOURCE / "docs/catalogue.md").read_text(encoding="utf-8")
        told = re.findall(r"(?m)^\| `([a-z-]+)` \|", rows)
        self.assertEqual(sorted(told), sorted(path.stem for path in (tool.SOURCE / "models").rglob("*.toml")))

    def test_prints_a_file(self):
        out, _ = self.run_tool("models", "crossing", code=0)
        self.assertEqual(out, (tool.SOURCE / "models/crossing.toml").read_text(encoding="utf-8"))
        self.assertIn("did you mean 'crossing'?", self.run_tool("models", "crosing", code=2)[1])

    def test_another_folder_comes_first(self):
        self.write("crossing.toml", MODEL)
        self.write("mine.toml", MODEL)
        out, _ = self.run_tool("models", code=0, environment={"SALTUS_MODELS": str(self.folder)})
        self.assertRegex(out, r"(?m)^crossing +two speeds$")
        self.assertRegex(out, r"(?m)^mine +two speeds$")
        self.assertIn("sliding", out)


if __name__ == "__main__":
    tool.main()

"""What the contract of the tool says beyond formats: values at breaks, rows, options without effect, streams."""

import json
import subprocess

from tool import TOOL, WAIT, ToolTest, main

BREAKS = """
[model]
name = "breaks"
[states]
x = -3
[controls]
u = 0
[dynamics]
x = "floor(4*t) + u - sign(x + 3.1 - 2*floor(2*t))"
[outputs]
f = "floor(4*t)"
[simulate]
until = 1
inputs = { u = { file = "u.csv" } }
[simulate.fesd]
steps = 4
[simulate.timestepping]
steps = 4
"""

FRICTION = """
[model]
name = "friction"
[states]
v = 1
[dynamics]
v = "-sign(v)"
[simulate]
until = 2
"""


class BreaksTest(ToolTest):
    def run_method(self, *arguments):
        self.write("u.csv", "t,u\n0,1\n0.5,2\n1,3\n")
        self.write("breaks.toml", BREAKS)
        self.run_tool("simulate", "breaks.toml", "--out", "r.json", "--quiet", *arguments, code=0)
        return json.loads((self.folder / "r.json").read_text())

    def test_values_are_continuous_from_the_right_at_the_end_too(self):
        for method in ("event", "smoothed", "fesd", "timestepping"):
            for rows in ("steps", None):
                output = ["--set", "simulate.output=steps" if rows else "simulate.output.every=0.25"]
                result = self.run_method("--method", method, *output)
                trajectory = result["trajectory"]
                with self.subTest(method=method, rows=rows):
                    self.assertEqual(result["final"]["outputs"], [4.0])
                    self.assertEqual(trajectory["u"][-1], [3.0])
                    self.assertEqual(result["events"][-1]["t"], 1.0)  # the switching function jumps there
                    for t, f in ((0.25, 1.0), (0.5, 2.0), (0.75, 3.0)):
                        row = max(k for k, time in enumerate(trajectory["t"]) if abs(time - t) < 1e-14)
                        self.assertEqual(trajectory["outputs"][row], [f])
                        self.assertEqual(trajectory["u"][row], [1.0 if t < 0.5 else 2.0])

    def test_an_event_at_the_end_of_a_step_has_two_rows(self):
        for method in ("fesd", "timestepping"):
            result = self.run_method("--method", method)
            for event in result["events"]:
                with self.subTest(method=method, t=event["t"]):
                    self.assertEqual(result["trajectory"]["t"].count(event["t"]), 2)


class StreamsTest(ToolTest):
    def run_with_input(self, text, *arguments, code):
        done = subprocess.run([TOOL, *arguments], cwd=self.folder, input=text, capture_output=True, text=True, timeout=WAIT)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout, done.stderr

    def test_a_model_comes_from_standard_input(self):
        out, _ = self.run_with_input(FRICTION, "simulate", "-", code=0)
        self.assertIn("enter_sliding", out)
        _, err = self.run_with_input(FRICTION.replace("-sign", "-sgn"), "simulate", "-", code=2)
        self.assertIn("<standard input>:7:7: error: unknown function 'sgn'", err)

    def test_standard_output_that_cannot_be_written(self):
        self.write("friction.toml", FRICTION)
        for arguments in (["simulate", "friction.toml"], ["models"], ["check", "friction.toml"]):
            with open("/dev/full", "w") as full, self.subTest(arguments=arguments):
                done = subprocess.run([TOOL, *arguments], cwd=self.folder, stdout=full, stderr=subprocess.PIPE,
                                      text=True, timeout=WAIT)
                self.assertEqual(done.returncode, 2)
                self.assertIn("cannot write to standard output: No space left on device", done.stderr)


class NamesTest(ToolTest):
    MODEL = """[model]
name = "m"
[parameters]
w = 2
k = 1
x0 = 1
[states]
x = "x0"
[controls]
u = 0
[dynamics]
x = "-k*x + u"
[simulate]
until = 1
inputs = { u = "sin(w*t)" }
"""

    def test_what_a_setting_replaces_uses_its_names(self):
        self.write("m.toml", self.MODEL)
        self.write("u.csv", "t,u\n0,0\n1,1\n")
        for setting in ("simulate.inputs.u.file=u.csv", "simulate.inputs.u=0", 'simulate.inputs={ u = "t" }',
                        "dynamics.x=-x", "states.x=2", "u=1", "x=2"):
            self.assertEqual(self.run_tool("simulate", "m.toml", "--quiet", "--set", setting, code=0)[1], "", setting)
        self.write("m.toml", self.MODEL.replace("k = 1", "k = 1\nunused = 1"))
        err = self.run_tool("simulate", "m.toml", "--quiet", "--set", "dynamics.x=-x", code=0)[1]
        self.assertIn("parameter 'unused' is never used", err)


class OptionsWithoutEffectTest(ToolTest):
    def warnings(self, command, *arguments):
        self.write("friction.toml", FRICTION + '[simulate.timestepping]\nstep_bounds = 0.5\n[simulate.fesd]\nrho = 2\n')
        _, err = self.run_tool(command, "friction.toml", "--quiet", *arguments, code=0)
        return err

    def test_what_is_typed_and_has_no_effect_is_told(self):
        err = self.warnings("simulate", "--method", "fesd", "--rtol", "1e-3", "--integrator", "dop853",
                            "--set", "simulate.smoothed.epsilon=1")
        self.assertIn('warning: --rtol 1e-3 has no effect: the accuracy of method "fesd" is that of its steps', err)
        self.assertIn('warning: --integrator dop853 has no effect: it is for method "event"', err)
        self.assertIn('warning: --set simulate.smoothed.epsilon has no effect: it is for method "smoothed"', err)
        self.assertIn("friction.toml:13: simulate.fesd.rho has no effect: this step_equilibration has no objective", err)
        self.assertNotIn("step_bounds", err)  # of another method: the file is for both

    def test_what_the_method_of_the_file_ignores_is_told(self):
        err = self.warnings("simulate", "--method", "timestepping")
        self.assertIn("friction.toml:11: simulate.timestepping.step_bounds has no effect: elements of method", err)
        self.assertNotIn("simulate.fesd", err)
        # "the same keys as fesd" (interface.md), the same values, too.
        err = self.warnings("simulate", "--method", "timestepping", "--set",
                            "simulate.timestepping.step_equilibration=l2_relaxed")
        self.assertIn("step_equilibration has no effect: elements of method", err)

    def test_nothing_is_told_of_options_that_work(self):
        self.assertEqual(self.warnings("simulate", "--rtol", "1e-9", "--integrator", "radau5"), "")
        self.assertEqual(self.warnings("simulate", "--method", "smoothed", "--atol", "1e-9",
                                       "--set", "simulate.event.max_step=1"), "")
        # All methods run.
        self.assertEqual(self.warnings("compare", "--rtol", "1e-9", "--set", "simulate.fesd.stages=3"), "")

    def test_the_place_of_a_typed_option_is_what_was_typed(self):
        self.write("friction.toml", FRICTION)
        for arguments in (["--until", "-1"], ["--set", "simulate.until=-1"]):
            _, err = self.run_tool("simulate", "friction.toml", *arguments, code=2)
            self.assertTrue(err.startswith(f"{arguments[0]} {arguments[1].split('=')[0]}: error: until (-1)"), err)


class UndefinedTest(ToolTest):
    MODEL = """
[model]
name = "undefined"
[states]
x = 1
y = 0
[dynamics]
x = "-1"
y = "sign({})"
[simulate]
until = 3
"""

    def stop(self, function, *arguments):
        self.write("m.toml", self.MODEL.format(function))
        self.run_tool("simulate", "m.toml", "--out", "r.json", *arguments, code=3)
        status = json.loads((self.folder / "r.json").read_text())["status"]
        self.assertEqual(status["termination"], "evaluation_failed", status)
        self.assertAlmostEqual(status["time_reached"], 1.0, delta=1e-4)
        return status["message"]

    def test_a_switching_function_that_ends_is_named(self):
        for function, name in (("log(x) + 100 + x", "log(x)+100+x"), ("sqrt(x) + 1", "sqrt(x)+1")):
            for arguments in (["--integrator", "dopri5"], ["--integrator", "dop853"], ["--integrator", "radau5"],
                              ["--integrator", "taylor"],
                              ["--method", "fesd"], ["--method", "timestepping"]):
                with self.subTest(function=function, arguments=arguments):
                    message = self.stop(function, *arguments)
                    self.assertIn(f"'{name}' is not finite beyond t = ", message)
                    self.assertIn("guard the expression with if(", message)

    def test_a_condition_that_ends_is_named(self):
        self.MODEL = self.MODEL.replace("[simulate]", "[[events]]\nwhen = \"sqrt(x) - 7\"\n[simulate]")
        self.assertIn("an expression of [[events]] or [[jumps]] is not finite beyond t = ", self.stop("x + 5"))


class FewStepsTest(ToolTest):
    def test_every_model_says_that_its_steps_are_too_few(self):
        listed, _ = self.run_tool("models", code=0)
        names = [line.split()[0] for line in listed.split("\nof any size")[0].splitlines() if line]
        self.assertGreater(len(names), 80)
        methods = {name: ["event"] for name in names} | {"three-windings": ["event", "fesd"], "empty-circle": ["event", "fesd"]}
        for name, method in ((name, method) for name in names for method in methods[name]):
            with self.subTest(model=name, method=method):
                call = [TOOL, "simulate", name, "--method", method, "--set", "simulate.max_steps=5", "--quiet"]
                done = subprocess.run(call, capture_output=True, text=True, check=False)
                self.assertIn(done.returncode, (0, 3), done.stderr)
                self.assertEqual("max_steps = 5 reached" in done.stderr, done.returncode == 3, done.stderr)


if __name__ == "__main__":
    main()

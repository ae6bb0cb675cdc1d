"""Methods fesd and timestepping at the command line; their accuracy has its tests in tests/agreement and tests/order."""

import json
import math

import tool


class Elements(tool.ToolTest):
    def test_check_says_which_models_they_cover(self):
        self.assertIn("methods: event, smoothed, fesd, timestepping", self.run_tool("check", "stick-slip", code=0)[0])
        self.assertIn("fesd, timestepping: finite elements do not cover models with [[jumps]]",
                      " ".join(self.run_tool("check", "bouncing-ball", code=0)[0].split()))

    def test_stages_whose_modes_go_round_in_circles_are_searched(self):
        self.run_tool("simulate", "stick-slip", "--method", "timestepping", "--quiet", "--out", "r.json", "--set",
                      "simulate.timestepping.scheme=gauss_legendre", "--set", "simulate.timestepping.steps=50", code=0)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        # Of order 1: near the solution, not at it.
        self.assertLess(abs(result["final"]["x"][0] - 0.6289), 0.1)

    def test_stages_are_found_where_the_modes_of_the_left_end_have_none(self):
        # Implicit Euler from v = -0.01 with h = 1: below the belt's speed 2 v + 0.05 = 1/(1.2 - v) has no root, on it
        # alpha = 0.275 does it.
        self.run_tool("simulate", "stick-slip", "--method", "timestepping", "--quiet", "--out", "r.json", "--set",
                      "simulate.timestepping.stages=1", "--set", "simulate.timestepping.steps=1", "--until", "1", code=0)
        final = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["final"]
        self.assertAlmostEqual(final["x"][0], 0.24, delta=1e-12)
        self.assertAlmostEqual(final["x"][1], 0.2, delta=1e-12)

    def test_rows_inside_an_element_without_switch_detection_have_the_selections_of_its_stages(self):
        # The mass sticks from t = 0.245 on: the stages of the element from 0.2 to 0.4 slide with 0.26 and 0.66.
        self.run_tool("simulate", "stick-slip", "--method", "timestepping", "--quiet", "--out", "r.json", "--set",
                      "simulate.output.every=0.04", "--until", "0.4", "--set", "simulate.timestepping.steps=1", code=0)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        rows, elements = result["trajectory"], result["elements"]
        low, high = (value for value, in elements["selection"][-3:-1])
        self.assertTrue(0.2 < low < 0.3 < 0.6 < high < 0.7, (low, high))
        inside = [i for i, t in enumerate(rows["t"]) if 0.2 < t < 0.4]
        self.assertGreater(len(inside), 2)
        for i in inside:
            expected = low + (high - low) * (rows["t"][i] - 0.4 + 0.4 / 3) / (0.4 / 3)
            self.assertAlmostEqual(rows["alpha"][i][0], expected, delta=1e-9)
            self.assertEqual(rows["mode"][i], [0])

    def test_selections_that_slide_are_found_from_the_ends_of_their_range(self):
        # The equations of the element from t = 0.98 have two solutions on the circle, alpha = -0.82 and 0.80.
        self.run_tool("simulate", "rotating-oscillator", "--method", "timestepping", "--quiet", "--set",
                      "simulate.timestepping.steps=40", code=0)

    def test_sliding_at_the_origin_converges_to_the_roundings_of_the_field(self):
        # x = 0 has no roundings of its own to converge to: -sign(x) + t has.
        for scheme in ("radau_iia", "gauss_legendre", "lobatto_iiic"):
            self.run_tool("simulate", "leaving-sliding", "--method", "fesd", "--quiet", "--out", "r.json", "--set",
                          f"simulate.fesd.scheme={scheme}", code=0)
            result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
            self.assertEqual(result["statistics"]["rejected"], 0, scheme)
            self.assertAlmostEqual(result["final"]["x"][0], 0.125, delta=1e-12)

    def test_no_switch_of_many_surfaces_is_lost(self):
        # Blocks whose friction changes sign at nearly the same times: one event or two, but the same surfaces.
        blocks = range(16)
        rates = [f'v{i} = "{f"q{i - 1}" if i else 0} - 2.5*q{i} + {f"q{i + 1}" if i < 15 else 0} - sign(v{i} - 0.2)"'
                 for i in blocks]
        model = self.write("chain.toml", "\n".join(
            ["[model]", 'name = "chain"', "[states]", *(f"q{i} = {0.1 * (7 * i % 5 - 2):.1f}" for i in blocks),
             *(f"v{i} = 0" for i in blocks), "[dynamics]", *(f'q{i} = "v{i}"' for i in blocks), *rates]))
        switches = []
        for method in ("event", "fesd"):
            self.run_tool("simulate", model, "--method", method, "--until", "10", "--quiet", "--out", "r.json", code=0)
            events = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["events"]
            switches.append(sorted((name, event["kind"], event["t"]) for event in events for name in event["surfaces"]))
        self.assertGreater(len(switches[0]), 20)
        self.assertEqual([entry[:2] for entry in switches[0]], [entry[:2] for entry in switches[1]])
        for (_, _, expected), (_, _, found) in zip(*switches):
            self.assertAlmostEqual(found, expected, delta=1e-3)

    def test_indicators_that_are_not_finite_are_told(self):
        self.write("m.toml", """
[model]
name = "m"
[states]
x = 2
y = 1
[dynamics]
x = "1"
y = "1 - 2*step(y + log(1 - x))"
[simulate]
until = 1
method = "fesd"
fesd = { reformulation = "stewart" }
""")
        _, errors = self.run_tool("simulate", "m.toml", "--quiet", "--out", "r.json", code=3)
        self.assertIn("indicators of regions are not finite at t = 0", " ".join(errors.split()))
        status = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["status"]
        self.assertEqual(status["termination"], "evaluation_failed")

    def run_to_end_of_selection(self, start, field, code):
        (self.folder / "root.toml").write_text(
            f'[model]\nname = "root"\ninclusion = "aizerman_pyatnitskii"\n[states]\nx = {start}\n[dynamics]\n'
            f'x = "{field}"\n[simulate]\nuntil = 4\n', encoding="utf-8")
        return self.run_tool("simulate", "root.toml", "--method", "fesd", "--quiet", "--out", "r.json", code=code)[1]

    def test_sliding_ends_at_a_double_root_of_a_selection(self):
        # s + s^2/2 = 0.4 sin t - 0.3, the root of s and -2 - s meet at -1: sin t = -1/2. And its mirror image.
        for start, field, mode in ((1, "-sign(x)*(1 + 0.5*sign(x)) + 0.4*sin(t) - 0.3", -1),
                                   (-1, "-sign(x)*(1 - 0.5*sign(x)) - 0.4*sin(t) + 0.3", 1)):
            self.run_to_end_of_selection(start, field, code=0)
            end = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["events"][-1]
            self.assertEqual((end["kind"], end["mode_after"]), ("leave_sliding", [mode]))
            self.assertAlmostEqual(end["t"], 7 * math.pi / 6, delta=1e-9)

    def test_a_step_without_active_sets_is_tried_as_a_problem_with_complementarities(self):
        # A selection with a fourfold root at its bound: neither finds a solution, and both say so.
        errors = self.run_to_end_of_selection(1, "-((1 + sign(x))^4 - 1)/2 + 0.4*sin(t) - 0.3", code=3)
        self.assertIn("problem with complementarities of the step at t =", " ".join(errors.split()))

    def test_a_super_twisting_controller_comes_to_rest(self):
        self.run_tool("simulate", "super-twisting", "--method", "fesd", "--quiet", "--out", "r.json", code=0)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertEqual(result["events"][-1]["kind"], "accumulation")
        self.assertEqual(result["final"]["x"], [0, 0])

    def run_terminal(self, exponent, *options):
        (self.folder / "terminal.toml").write_text(
            '[model]\nname = "terminal"\n[states]\nx = 1\n[dynamics]\n'
            f'x = "-abs(x)^({exponent})*sign(x) + 0.5*cos(2*t)"\n[simulate]\nuntil = 10\n', encoding="utf-8")
        self.run_tool("simulate", "terminal.toml", "--method", "fesd", "--quiet", "--out", "r.json", *options, code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def test_cubic_roots_are_crossed_with_few_stages(self):
        # x(10) by the methods "event" (rtol = 1e-13) and "fesd" (four stages, 400 steps), which agree to 4e-13.
        for stages, error in ((1, 2e-3), (2, 2e-7), (3, 2e-8), (4, 1e-9)):
            result = self.run_terminal("1/3", "--set", f"simulate.fesd.stages={stages}")
            self.assertAlmostEqual(result["final"]["x"][0], 0.0524269211251, delta=error)
            # Elements whose polynomials could not be those of a constant field were divided 400 times over.
            self.assertLess(result["statistics"]["steps"], 2000)

    def test_switches_that_roundings_repeat_do_not_stop_time(self):
        # x leaves 0 like (0.5 cos 2t)^4: cycles that seem to shrink to 1e-23 where time has roundings of 1e-16.
        result = self.run_terminal("1/4", "--until", "2.5", "--set", "simulate.fesd.stages=4")
        self.assertAlmostEqual(result["final"]["x"][0], 3.21380053e-4, delta=1e-9)
        self.assertLess(result["statistics"]["steps"], 2000)

    def test_derivatives_of_roots_are_refused(self):
        _, errors = self.run_tool("simulate", "super-twisting", "--method", "fesd", "--quiet",
                                  "--set", "simulate.fesd.sensitivities=true", code=2)
        self.assertIn("sensitivities do not cover roots", " ".join(errors.split()))

    def test_roots_of_zero_in_a_switching_function_are_told(self):
        (self.folder / "root.toml").write_text(
            '[model]\nname = "root"\n[states]\nx = 0\ny = 0.5\n[dynamics]\nx = "y"\n'
            'y = "-sign(y + abs(x)^0.6*sign(x))"\n[simulate]\nuntil = 1\n', encoding="utf-8")
        _, errors = self.run_tool("simulate", "root.toml", "--method", "fesd", "--quiet", "--out", "r.json", code=3)
        for part in ("the switching function of y+abs(x)^0.6*sign(x)", "has no finite derivative by x at t = 0", "method = \"event\""):
            self.assertIn(part, " ".join(errors.split()))
        status = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["status"]
        self.assertEqual(status["termination"], "evaluation_failed")

    def write_quadrants(self, rates):
        """The same model by indicators, and by conditions; z' in pp, pm, mp, mm."""
        fields = {"pp": ("-x-y", "x > 0 and y > 0", -1, -0.7), "pm": ("-x+y", "x > 0 and y < 0", -0.5, 1.2),
                  "mp": ("x-y", "x < 0 and y > 0", 0.9, -1), "mm": ("x+y", "x < 0 and y < 0", 1, 0.8)}
        for name, key in (("quad.toml", 0), ("when.toml", 1)):
            modes = ""
            for (mode, field), z in zip(fields.items(), rates):
                region = f'name = "{mode}"\nindicator = "{field[0]}"' if key == 0 else f'when = "{field[1]}"'
                modes += f'[[modes]]\n{region}\ndynamics = {{ x = {field[2]}, y = {field[3]}, z = {z} }}\n'
            (self.folder / name).write_text(
                f'[model]\nname = "quad"\n[states]\nx = 0.7\ny = 0.4\nz = 0\n{modes}[simulate]\nuntil = 3\n',
                encoding="utf-8")

    def end_of(self, model, *arguments):
        self.run_tool("simulate", model, "--quiet", "--out", "r.json", *arguments, code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def test_four_quadrants_by_indicators_are_told(self):
        # g1 + g4 = g2 + g3: at the origin four weights and three equations, and z feels the one that is free.
        self.write_quadrants((1, 0, 0, 2))
        event, conditions = self.end_of("quad.toml"), self.end_of("when.toml")
        for x, reference in zip(event["final"]["x"], conditions["final"]["x"]):
            self.assertAlmostEqual(x, reference, delta=1e-10)
        self.assertEqual(event["final"]["regions"], [["pp", "pm", "mp", "mm"]])
        self.assertEqual([e["unique"] for e in event["events"]], [True, False])
        self.assertIn("soft minima", event["events"][-1]["reason"])
        result = self.end_of("quad.toml", "--method", "fesd")
        self.assertIn("sliding on pp, pm, mp do not determine all weights", result["status"]["message"])
        self.assertEqual([event["unique"] for event in result["events"]], [True, False])

    def test_four_quadrants_that_move_one_way_agree(self):
        self.write_quadrants((0.7, -0.7, 2.9, 1.2))  # 1 + x' - y': whatever the weights are, z = t + x - y + const
        event, elements = self.end_of("quad.toml"), self.end_of("quad.toml", "--method", "fesd")
        self.assertEqual([e["unique"] for e in event["events"]], [True, True])
        for run in (event, elements):  # constant fields: exact for both
            for x, exact in zip(run["final"]["x"], (0, 0, 3 - 0.7 + 0.4)):
                self.assertAlmostEqual(x, exact, delta=1e-10)

    def test_timestepping_divides_elements_that_have_no_active_sets(self):
        for stages in (2, 3, 4):
            for steps in (20, 40):
                self.run_tool("simulate", "irma", "--method", "timestepping", "--quiet", "--out", "r.json", "--set",
                              f"simulate.timestepping.stages={stages}", "--set", f"simulate.timestepping.steps={steps}",
                              code=0)
                result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
                self.assertGreater(result["statistics"]["rejected"], 0, (stages, steps))

    def test_lengths_without_an_exact_rule_have_no_sensitivities(self):
        _, errors = self.run_tool("simulate", "crossing", "--method", "fesd", "--set", "simulate.fesd.sensitivities=true",
                                  "--set", "simulate.fesd.step_equilibration=heuristic_mean", code=2)
        self.assertIn("step_equilibration", errors)


if __name__ == "__main__":
    tool.main()

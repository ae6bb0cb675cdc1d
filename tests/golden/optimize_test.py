"""saltus optimize from outside: help, bad input, files."""

import itertools
import json
import math
import re

import tool

CAR = (tool.SOURCE / "models/turbo-car.toml").read_text(encoding="utf-8")


class OptimizeHelp(tool.ToolTest):
    def test_help(self):
        text, _ = self.run_tool("optimize", "--help", code=0)
        self.assertLessEqual(max(map(len, text.splitlines())), 120)
        for part in ("--intervals N", "--start RESULT.json", "--solver S", "--time-limit S", "--set NAME=VALUE", "--out FILE",
                     "--report FILE.html", "--quiet", "mpcc.sigma_final", "control_intervals", "running_cost"):
            self.assertIn(part, text)
        self.assertEqual(text.rstrip().splitlines()[-2], "Example:")


class OptimizeBadInput(tool.ToolTest):
    def refused(self, expected, *arguments, model=CAR):
        self.write("car.toml", model)
        out, err = self.run_tool("optimize", "car.toml", *arguments, code=2)
        self.assertIn(expected, err)
        self.assertEqual(out, "")

    def test_a_model_without_optimize(self):
        out, err = self.run_tool("optimize", "crossing", code=2)
        self.assertIn("no table [optimize]", err)
        with_option = self.run_tool("optimize", "crossing", "--time-limit", "20", code=2)[1]
        self.assertEqual(with_option, err)
        self.assertIn("saltus simulate", err)
        self.assertEqual(out, "")

    def test_options(self):
        self.refused("--intervals 0: error: expected a whole number >= 1, found 0", "--intervals", "0")
        self.refused("--time-limit -1: error:", "--time-limit", "-1")
        self.refused("--solver snopt: error: expected \"structured\" or \"ipopt\"", "--solver", "snopt")
        self.refused("did you mean 'optimize.elements'?", "--set", "optimize.elemens=2")
        self.refused("expected a whole number >= 1", "--set", "optimize.elements=0")
        self.refused("elements has 2 entries, control_intervals is 10", "--set", "optimize.elements=[1,2]")
        self.refused("a length of time > 0", "--set", "optimize.horizon=0")
        self.refused("none.json", "--start", "none.json")
        self.refused("no number of control intervals", model=CAR.replace("control_intervals = 10\n", ""))
        self.refused("must end in .json or .csv", "--out", "r.txt")

    def test_it_can_still_be_simulated_and_checked(self):
        self.write("car.toml", CAR)
        self.run_tool("simulate", "car.toml", "--quiet", code=0)
        text, _ = self.run_tool("check", "car.toml", code=0)
        self.assertIn("optimal control", text)


FOLLOW = """
[model]
name = "follow a table"
[states]
x = 0
v = 0
[controls]
u = { lower = -5, upper = 5 }
[tables.r]
x = [0, 1, 2]
y = [0, 1, 0]
[dynamics]
x = "v"
v = "u - 0.5*sign(v)"
[optimize]
horizon = 2
control_intervals = 4
running_cost = "(x - r(t))^2"
"""


class OptimizeTables(tool.ToolTest):
    def test_a_table_of_the_time_in_a_cost(self):
        self.write("follow.toml", FOLLOW)
        text, _ = self.run_tool("check", "follow.toml", code=0)
        self.assertNotIn("never used", text)
        self.run_tool("optimize", "follow.toml", "--quiet", "--out", "r.json", code=0)
        objective = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["objective"]
        self.assertLess(abs(objective - 0.0071556), 1e-7)  # of (x - min(t, 2 - t))^2

    def test_a_break_inside_an_interval(self):
        self.write("follow.toml", FOLLOW)
        for command in ("check", "optimize"):
            _, err = self.run_tool(command, "follow.toml", "--set", "optimize.control_intervals=3", code=2)
            self.assertIn("follow.toml:18:22: error: 'r(t)' breaks at t = 1, inside control interval 1", err)
            self.assertIn("control_intervals = 4 has an end there", err)


PERIODIC = """
[model]
name = "periodic block"
[states]
q = { initial = 0, lower = -1, upper = 1, free = true }
v = { initial = 0.5, lower = -3, upper = 3, free = true }
[controls]
u = { lower = -4, upper = 4 }
[dynamics]
q = "v"
v = "u - q - 0.5*sign(v)"
[optimize]
horizon = 6
control_intervals = 12
running_cost = "0.1*u^2 + (q - sin(t*pi/3))^2"
terminal_constraints = ["q == initial(q)", "v == initial(v)"]
"""


class OptimizeInitialValues(tool.ToolTest):
    def test_a_periodic_problem_and_its_result(self):
        self.write("periodic.toml", PERIODIC)
        self.run_tool("check", "periodic.toml", code=0)
        self.run_tool("optimize", "periodic.toml", "--quiet", "--out", "r.json", code=0)
        r = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        for first, last in zip(r["trajectory"]["x"][0], r["final"]["x"], strict=True):
            self.assertLess(abs(last - first), 1e-7)
        self.assertEqual(r["parameters"], {})
        self.assertEqual(r["model"]["parameters"], {})
        text, _ = self.run_tool("optimize", "periodic.toml", "--start", "r.json", code=0)
        self.assertIn("completed", text)
        self.run_tool("simulate", "r.json", "--until", "1", "--quiet", code=0)

    def test_elsewhere(self):
        self.write("cost.toml", PERIODIC.replace("(q - sin(t*pi/3))", "(q - initial(q))"))
        for command in ("check", "optimize"):
            _, err = self.run_tool(command, "cost.toml", code=2)
            self.assertIn("cost.toml:15:32: error: 'initial(q)' may stand in terminal_constraints and terminal_cost of", err)
            self.assertIn("write the number or the parameter that is the initial value in [states]", err)
        self.write("input.toml", PERIODIC.replace("initial(v)", "initial(u)"))
        _, err = self.run_tool("optimize", "input.toml", code=2)
        self.assertIn("input.toml:16:58: error: expected the name of a state in initial(...), found 'u'", err)


class OptimizeComplementarities(tool.ToolTest):
    def test_a_control_in_a_pair_is_said_to_be_constant(self):
        model = FOLLOW.replace("(x - r(t))^2", "(x - 0.1*t)^2") + 'path_complementarities = [["x", "u + 5"]]\n'
        self.write("pair.toml", model)
        expected = "pair.toml:19: the pair ['x', 'u+5'] of path_complementarities has the control 'u', which is constant in each"
        text, _ = self.run_tool("check", "pair.toml", code=0)
        self.assertIn(expected, " ".join(text.split()))
        _, err = self.run_tool("optimize", "pair.toml", "--time-limit", "10", "--quiet", code=0)
        self.assertIn(expected, err)


FIT = """
[model]
name = "fit"
[parameters]
k = { initial = 2, lower = 1, upper = 5, free = true }
[states]
x = -0.55
[dynamics]
x = "if(x > 0, k, 1)"
[optimize]
horizon = 1.1
control_intervals = 2
[[optimize.least_squares]]
of = ["x"]
reference = { file = "data.csv" }
at = "times"
"""


class OptimizeMeasurements(tool.ToolTest):
    def test_a_parameter_from_times_of_their_own(self):
        self.write("fit.toml", FIT)
        rows = "t,x\n0.2,-0.35\n0.5,-0.05\n0.6,0.15\n0.9,1.05\n"  # switches at t = 0.55
        self.write("data.csv", rows)
        self.run_tool("optimize", "fit.toml", "--quiet", "--out", "r.json", code=0)
        r = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertLess(abs(r["parameters"]["k"] - 3), 1e-7)
        for more, expected in (("1.3,1\n", "data.csv:6:1: error: row 5: the time 1.3 is outside of the horizon, from 0 to 1.1"),
                               ("0.8,1\n", "data.csv:6:1: error: row 5: the time 0.8 is behind 0.9, of the row before"),
                               ("nan,1\n", "data.csv:6:1: error: expected a finite number, found 'nan'")):
            self.write("data.csv", rows + more)
            for command in ("check", "optimize"):
                _, err = self.run_tool(command, "fit.toml", code=2)
                self.assertIn(expected, err)


IDLE = """
[model]
name = "idle"
[states]
x = 0
y = { initial = 0, lower = -1, upper = 1 }
[controls]
u = { lower = -1, upper = 1, initial = 3 }
[dynamics]
x = "-1 - 0.5*sign(x)"
y = "u"
[optimize]
horizon = 1
control_intervals = 2
running_cost = "x^2"
minimize_time = true
"""


class OptimizeCheck(tool.ToolTest):
    def test_sizes_and_warnings(self):
        self.write("idle.toml", IDLE)
        text, _ = self.run_tool("check", "idle.toml", code=0)
        self.assertRegex(text, r"(?m)^ +variables +equations +pairs +nonzeros$")
        self.assertRegex(text, r"(?m)^  interval 0 +\d+ +\d+ +\d+ +\d+$")
        self.assertRegex(text, r"(?m)^  problem +\d+ +\d+ +\d+ +\d+$")
        for warning in ("the initial state is on the surface x = 0", "moved onto the bounds [-1, 1]",
                        "minimize_time adds a constant", "influences running_cost"):
            self.assertIn(warning, text)


# Implicit Euler is wrong by several percent in each interval, and the system makes 20 of every 1 of it.
UNSTABLE = """[model]
name = "unstable"
[states]
x = 1
[controls]
u = { lower = -50, upper = 50 }
[dynamics]
x = "3*x + u"
[optimize]
horizon = 1
control_intervals = 10
elements = 1
scheme = "radau_iia"
stages = 1
running_cost = "u^2"
terminal_cost = "100*x^2"
verification_tolerance = 1
"""


# Lands at 0.101 s, and would fall over: x grows with 10 1/s.
LANDER = """
[model]
name = "lander"
[parameters]
push = 0
[states]
x = 0.01
z = 0.05
vx = 0
vz = 0
[controls]
u = { lower = -2, upper = 2 }
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
mass = [[1, 0], [0, 1]]
force = { vx = "100*x + push + u", vz = "-9.81" }
[[contacts]]
name = "foot"
gap = "z"
[time_freezing]
a_n = 20
[optimize]
horizon = 0.6
control_intervals = 2
elements = 4
stages = 4
closed_loop = true
running_cost = "u^2 + x^2"
terminal_cost = "1000*(x^2 + vx^2)"
plant = { push = 0.15 }
"""


HOIST = """
[model]
name = "hoist with two gears"
[parameters]
F = 0.4
[states]
q = 0
v = 0
[controls]
u = { lower = -1, upper = 1 }
[dynamics]
q = "v"
v = "if(v > 0.8, 0.6, 1.2)*u - F*sign(v) - 0.2*v"
[optimize]
horizon = { free = true, initial = 4, lower = 0.5, upper = 12 }
control_intervals = 12
minimize_time = true
terminal_constraints = ["q == 2", "v == 0"]
closed_loop = true
plant = { F = 0.45 }
"""


class Infeasible(tool.ToolTest):
    def test_each_row_is_named_once_and_what_is_not_known_is_no_error(self):
        text = HOIST.replace("{ free = true, initial = 4, lower = 0.5, upper = 12 }", "0.1").replace("minimize_time = true", 'running_cost = "u^2"')
        self.write("m.toml", text.replace("= 12\n", "= 4\n"))
        out, _ = self.run_tool("optimize", "m.toml", "--out", "r.json", code=3)
        message = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["status"]["message"]
        named = re.split(r" \(by [^)]*\)(?:, )?", message.partition(": ")[2])[:-1]
        self.assertEqual(len(named), len(set(named)), message)
        self.assertIn("terminal constraint 'q == 2'", message)
        self.assertNotIn("unknown error", out)


class SeveralStarts(tool.ToolTest):
    def test_the_best_is_taken_and_all_are_listed(self):
        out, _ = self.run_tool("optimize", "turbo-car", "--set", "optimize.mpcc.starts=3", "--out", "r.json", code=0)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        starts = result["starts"]
        self.assertEqual([start["seed"] for start in starts], [0, 1, 2])
        taken = [start for start in starts if start["is_taken"]]
        self.assertEqual([start["objective"] for start in taken], [result["objective"]])
        self.assertEqual(result["objective"], min(start["objective"] for start in starts if start["termination"] == "completed"))
        self.assertIn("starts (*: taken)", out)
        self.assertIn("a whole number from 1 to 1000", self.run_tool("optimize", "turbo-car", "--set", "optimize.mpcc.starts=0", code=2)[1])


class ClosedLoop(tool.ToolTest):
    def test_feedback_brings_it_there_where_the_open_loop_does_not(self):
        file = self.write("m.toml", UNSTABLE)
        self.run_tool("optimize", file, "--set", "optimize.closed_loop=true", "--quiet", "--out", "r.json", code=0)
        verification = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["verification"]
        open_loop, closed_loop = verification["open_loop"], verification["closed_loop"]
        self.assertGreater(open_loop["end_state_error"], 0.05)
        self.assertLess(closed_loop["end_state_error"], 0.2 * open_loop["end_state_error"])
        self.assertEqual(closed_loop["termination"], "completed")
        self.assertEqual(closed_loop["x"][0], [1.0])
        out, _ = self.run_tool("optimize", file, "--set", "optimize.closed_loop=true", code=0)
        self.assertIn("With feedback from the states", " ".join(out.split()))

    def optimised(self, *settings):
        arguments = [word for one in settings for word in ("--set", one)]
        self.run_tool("optimize", "m.toml", *arguments, "--quiet", "--out", "r.json", code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def test_a_controller_that_tracks_the_plan(self):
        """Where the end costs little it is optimal to let an error grow; a controller that tracks the plan does not."""
        self.write("m.toml", UNSTABLE.replace("100*x^2", "0.001*x^2").replace("stages = 1", "stages = 3"))
        settings = ["optimize.closed_loop=true", "optimize.plant.x=1.1"]
        ends = {feedback: self.optimised(*settings, f"optimize.feedback={feedback}")["verification"]["closed_loop"]["end_state_error"]
                for feedback in ("optimal", "tracking")}
        self.assertGreater(ends["optimal"], 0.05)
        self.assertLess(ends["tracking"], 1e-3)
        _, err = self.run_tool("optimize", "m.toml", "--set", "optimize.feedback=none", code=2)
        self.assertIn("tracking", err)

    def test_elements_that_start_where_the_horizon_ends_are_not_corrected(self):
        self.write("m.toml", HOIST)
        for intervals in (7, 12):
            result = self.optimised("optimize.feedback=tracking", f"optimize.control_intervals={intervals}")
            rows = result["verification"]["closed_loop"]
            self.assertEqual(rows["termination"], "completed")
            self.assertAlmostEqual(rows["t"][-1], result["grid"][-1])
        for settings, plant in (["optimize.plant={}"], {}), (["optimize.plant={ v = 0.1 }"], {"v": 0.1}), \
                (["optimize.plant.v=0.1"], {"F": 0.45, "v": 0.1}):
            result = self.optimised("optimize.control_intervals=4", *settings)
            self.assertEqual(result["verification"].get("plant", {}), plant)

    def test_gains_are_in_the_result(self):
        """A row per control, a column per state, by time."""
        self.write("m.toml", UNSTABLE)
        result = self.optimised("optimize.closed_loop=true", "optimize.plant.x=1.001")
        loop = result["verification"]["closed_loop"]
        gains = loop["gains"]
        self.assertEqual([gain["interval"] for gain in gains], list(range(len(result["u"]))))
        for gain, t in zip(gains, result["grid"]):
            self.assertAlmostEqual(gain["t"], t)
            self.assertEqual([len(row) for row in gain["K"]], [1])
        self.assertEqual(gains[0]["K"], [[0.0]])
        self.assertLess(gains[1]["K"][0][0], 0)
        self.run_tool("report", "r.json", code=0)
        loop["gains"][1]["K"][0].append(1.0)
        self.write("bad.json", json.dumps(result))
        self.assertIn("gains/1/K", self.run_tool("report", "bad.json", code=2)[1])

    def test_tracking_corrects_where_elements_start(self):
        """Inside of intervals, too: at the node it would be too late for the controls that there are."""
        self.write("m.toml", LANDER)
        result = self.optimised("optimize.feedback=tracking")
        rows, times, points = result["verification"]["closed_loop"], result["elements"]["t"], result["elements"]["points"]
        self.assertLess(max(abs(x[0]) for x in rows["x"]), 0.02)
        starts = sorted({round(t, 6) for t in times[::points]})
        self.assertEqual(len(starts), 7)  # the landing takes no time
        # x'' = 100 x + w with the w of each pair of rows: constant from start to start, and another one behind each.
        pushes = {}
        for (t1, t2), (before, behind) in zip(itertools.pairwise(rows["t"]), itertools.pairwise(rows["x"])):
            if t2 - t1 < 1e-4:
                continue
            growth, rate = math.cosh(10 * (t2 - t1)), math.sinh(10 * (t2 - t1))
            w = 10 * ((behind[2] - growth * before[2]) / rate - 10 * before[0])
            pushes.setdefault(max(start for start in starts if start <= (t1 + t2) / 2), []).append(w)
        self.assertEqual(sorted(pushes), starts)
        means = [sum(values) / len(values) for _, values in sorted(pushes.items())]
        for values, mean in zip((pushes[start] for start in starts), means):
            self.assertLess(max(abs(value - mean) for value in values), 1e-4)
        for mean, other in itertools.pairwise(means):
            self.assertGreater(abs(mean - other), 1e-3)

    def test_the_optimal_feedback_corrects_at_nodes(self):
        """The push alone takes x + vx/10 to 0.15/100 (e^3 - 1) until then; more than 1.85/100 no control brings back."""
        self.write("m.toml", LANDER)
        rows = self.optimised("optimize.feedback=optimal")["verification"]["closed_loop"]
        at_node = next(x for t, x in zip(rows["t"], rows["x"]) if t >= 0.3)
        self.assertGreater(100 * at_node[0] + 10 * at_node[2], 1.85)
        self.assertGreater(rows["x"][-1][0], 0.1)

    def test_the_plant_may_differ_from_the_model(self):
        text = UNSTABLE.replace("3*x + u", "a*x + u").replace("[states]", "[parameters]\na = 3\n[states]")
        self.write("m.toml", text)
        as_planned = self.optimised("optimize.closed_loop=true")
        other = self.optimised("optimize.closed_loop=true", "optimize.plant={ a = 3.5, x = 1.25 }", "optimize.plant.x=1.5")
        self.assertEqual(other["u"], as_planned["u"])
        self.assertEqual(other["verification"]["open_loop"], as_planned["verification"]["open_loop"])
        self.assertNotIn("plant", as_planned["verification"])
        self.assertEqual(other["verification"]["plant"], {"a": 3.5, "x": 1.5})
        rows = other["verification"]["closed_loop"]
        self.assertEqual(rows["x"][0], [1.5])
        # In the first interval: x' = 3.5 x + w, w constant.
        (t1, x1), (t2, x2) = ((rows["t"][i], rows["x"][i][0]) for i in (1, 2))
        w = 3.5 * (x1 - 1.5 * math.exp(3.5 * t1)) / (math.exp(3.5 * t1) - 1)
        self.assertAlmostEqual(x2, (1.5 + w / 3.5) * math.exp(3.5 * t2) - w / 3.5, places=8)
        self.write("m.toml", text + "closed_loop = true\nplant = { a = 3.5 }\n")
        out, _ = self.run_tool("optimize", "m.toml", code=0)
        self.assertIn("With feedback from the states, a = 3.5", " ".join(out.split()))

    def test_a_plant_that_cannot_be(self):
        self.write("m.toml", UNSTABLE.replace("x = 1\n", "x = { initial = 1, lower = 0, upper = 2, free = true }\n"))
        for plant, message in (("{ y = 1 }", "'y'"), ("{ x = 1 }", "is free"),
                               ("{ u = \"x\" }", "constant")):
            _, err = self.run_tool("optimize", "m.toml", "--set", "optimize.closed_loop=true", "--set",
                                   f"optimize.plant={plant}", code=2)
            self.assertIn(message, err)
        self.write("m.toml", UNSTABLE + "plant = { x = 2 }\n")
        self.assertIn("With feedback", self.run_tool("optimize", "m.toml", code=0)[0])
        _, err = self.run_tool("optimize", "m.toml", "--set", "optimize.closed_loop=false", code=2)
        self.assertRegex(err, r"m.toml:18:15: error: .*closed_loop is false")
        self.write("m.toml", UNSTABLE + "plant = 3\n")
        _, err = self.run_tool("optimize", "m.toml", code=2)
        self.assertIn("a table of parameters and initial values", err)

    def test_it_is_left_out_unless_it_is_asked_for(self):
        self.run_tool("optimize", self.write("m.toml", UNSTABLE), "--quiet", "--out", "r.json", code=0)
        self.assertNotIn("closed_loop", json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["verification"])
        _, err = self.run_tool("optimize", "m.toml", "--set", "optimize.closed_loop=perhaps", code=2)
        self.assertIn("true or false", err)


class Optimize(tool.ToolTest):
    def test_the_car_arrives_in_least_time(self):
        self.write("car.toml", CAR)
        out, err = self.run_tool("optimize", "car.toml", "--out", "car.json", "--out", "car.csv", code=0)
        self.assertEqual(err, "")
        result = json.loads((self.folder / "car.json").read_text(encoding="utf-8"))
        self.assertEqual(result["command"], "optimize")
        self.assertEqual(result["status"]["termination"], "completed")
        self.assertEqual(len(result["u"]), 10)
        self.assertAlmostEqual(result["trajectory"]["x"][-1][0], 200.0, places=6)
        self.assertAlmostEqual(result["horizon"], 40 / 3, places=6)  # the exact optimum, beside the model
        self.assertAlmostEqual(result["objective"], result["horizon"], places=9)
        self.run_tool("optimize", "car.toml", "--start", "car.json", "--quiet", code=0)


if __name__ == "__main__":
    tool.main()

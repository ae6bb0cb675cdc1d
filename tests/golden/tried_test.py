"""Models that people new to Saltus wrote: what they expected of it."""

import csv
import json

import tool

PWM = """
[model]
name = "PI with saturation and anti windup, PWM"
[parameters]
Kp = 2
Ki = 5
umax = 1
[states]
y = 0
i = 0
[definitions]
ref = "if(t > 1, 0.8, 0)"
e = "ref - y"
v = "Kp*e + Ki*i"
u = "max(min(v, umax), -umax)"
sat = "abs(v) - umax"
duty = "mod(t, 0.1)/0.1"
pwm = "if(u > duty, 1, 0)"
[dynamics]
y = "-y + pwm"
i = "if(sat > 0 and v*e > 0, 0, e)"
[simulate]
until = 8
"""

NAMES = """
[model]
name = "names"
[states]
x = 1
th = 0
[definitions]
s = "x - 0.5"
turn = "mod(th, 2*pi)"
[dynamics]
x = "if(s > 0, -1, 1) + if(0 < x, -1, -1.5) + 0*max(0, th - 3)"
th = 4
[outputs]
turns = "floor(th/(2*pi))"
record = ["s", "turn"]
[simulate]
until = 4
"""

FEEDBACK = """
[model]
name = "negative feedback loop of two genes"
[states]
A = 0.3
B = 0.9
[dynamics]
A = "if(B < 0.5, 1, 0) - A"
B = "if(A > 0.5 , 1, 0) - B"
[simulate]
until = 20
max_events = 2000
"""

PUCK = """
[model]
name = "puck on a table: planar dry friction"
[parameters]
mu = 0.3
[states]
x = 0
y = 0
vx = 3
vy = 2
[definitions]
speed = "hypot(vx, vy)"
[dynamics]
x = "vx"
y = "vy"
vx = "-mu*9.81*vx/speed"
vy = "-mu*9.81*vy/speed"
[simulate]
until = 3
max_steps = 20000
"""

DOSES = """
[model]
name = "doses that are held while neutrophils are low"
[parameters]
Circ0 = 5
MTT = 3.7
gamma = 0.161
slope = 8
k = 0.5
dose = 1
[definitions]
ktr = "4/MTT"
E = "min(slope*A, 1)"
[states]
A = 0
Prol = "Circ0"
T1 = "Circ0"
T2 = "Circ0"
T3 = "Circ0"
Circ = "Circ0"
next = 0
doses = 0
held = 0
[dynamics]
A = "-k*A"
Prol = "ktr*Prol*(1 - E)*(Circ0/Circ)^gamma - ktr*Prol"
T1 = "ktr*(Prol - T1)"
T2 = "ktr*(T1 - T2)"
T3 = "ktr*(T2 - T3)"
Circ = "ktr*(T3 - Circ)"
next = 0
doses = 0
held = 0
[[jumps]]
name = "visit"
at = [0, 7, 14, 21, 28, 35, 42, 49, 56, 63, 70, 77, 84, 91, 98, 105, 112, 119, 126]
[jumps.set]
A = "A + if(t >= next and Circ > 1, dose, 0)"
next = "if(t >= next, t + if(Circ > 1, 21, 7), next)"
doses = "doses + if(t >= next and Circ > 1, 1, 0)"
held = "held + if(t >= next and Circ <= 1, 1, 0)"
[simulate]
until = 130
"""

VALVE = """
[model]
name = "relay-valve"
[states]
y = 0
dy = 0
xa = 0
va = 0
I = 0
[definitions]
e = "1 - y"
u = "2*e + I + 0.8*sign(e)"
us = "min(u, 1.5)"
[dynamics]
y = "dy"
dy = "-1.4*dy - (y - xa)"
xa = "va"
va = "(us - xa - 0.3*va - 0.15*sign(va))/0.05"
I = "e + 2*(us - u)"
[simulate]
until = 60
"""

SERVO = """
[model]
name = "servo with integral action and dry friction"
[parameters]
Ki = 0.5
[states]
I = 0
p = 0
w = 0
[dynamics]
I = "Ki*(1 - p)"
p = "w"
w = "20*(I - p) - 4*w - 0.5*sign(w)"
[simulate]
until = 300
"""

VALVE = """
[model]
name = "sticky valve behind a PI controller"
[states]
I = 0
y = 0
x = 0
v = 0
[dynamics]
I = "0.5*(1 - y)"
y = "x - y"
x = "v"
v = "50*(3*(1 - y) + I - x) - 10*v - sign(v)"
[simulate]
until = 300
"""

RELAY = """
[model]
name = "relay"
[states]
x = 0
on = 1
[dynamics]
x = "2*on - 1"
on = 0
[[jumps]]
name = "off"
when = "on == 1 and x > 1"
set = { on = 0 }
[[jumps]]
name = "on"
when = "on == 0 and x < -1"
set = { on = 1 }
[simulate]
until = 6.5
"""

# The switching function does not see the control's current at once.
SLIDING_CONTROL = """
[model]
name = "position control with an armature"
[states]
theta = 0
omega = 0
cur = 0
[definitions]
s = "omega + 8*(theta - 1)"
[dynamics]
theta = "omega"
omega = "(0.01*cur - 0.1*omega - 0.002*sin(3*t))/0.01"
cur = "(-24*sign(s) - cur - 0.01*omega)/0.5"
[simulate]
until = 10
"""

TABLE_OF_INPUT = """
[model]
name = "valve"
[states]
x = 0
[controls]
u = 0
[dynamics]
x = "opening(u)"
[tables.opening]
x = [0, 1]
y = [0, 2]
[[jumps]]
name = "full"
when = "x > 3 + 0*opening(u)"
set = { x = 0 }
[simulate]
until = 2
inputs = { u = { file = "u.csv" } }
"""


class Tried(tool.ToolTest):
    def simulated(self, text, *arguments, code=0):
        out, err = self.run_tool("simulate", self.write("m.toml", text), "--out", "r.json", *arguments, code=code)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8")), out, err

    def test_a_sticky_valve_slips_ever_more_slowly(self):
        """A step that is too long for what has decayed ends beyond a zero that the state has left."""
        result, _, _ = self.simulated(VALVE, "--integrator", "dopri5")
        for value, limit in zip(result["final"]["x"], [1.02, 1.0, 1.0, 0.0]):
            self.assertAlmostEqual(value, limit, delta=1e-9)

    def test_a_servo_slips_ever_more_slowly(self):
        """Its speed and its acceleration tend to 0 at the edge of sticking, down to their roundings."""
        self.write("servo.toml", SERVO)
        for integrator in ["auto", "dopri5", "dop853", "radau5", "radau9", "radau13", "taylor"]:
            self.run_tool("sweep", "servo.toml", "--over", "Ki=0.1:0.9:41", "--integrator", integrator, "--quiet", "--out",
                          "servo.csv", code=0)
            with open(f"{self.folder}/servo.csv", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
            for row in rows:
                with self.subTest(integrator=integrator, Ki=row["Ki"]):
                    self.assertEqual(row["status"], "completed")
                    self.assertLess(int(row["events"]), 100)
                    for name, value in (("I", 1.025), ("p", 1.0), ("w", 0.0)):  # exp(-0.1*300) is less than 1e-13
                        self.assertAlmostEqual(float(row[name]), value, delta=1e-9)

    def test_a_function_whose_selection_acts_on_nothing_stops_no_run(self):
        result, _, _ = self.simulated(PWM)
        self.assertEqual(result["status"]["termination"], "completed")
        # The integral part holds the mean of y at the reference, beside the ripple of the modulation.
        self.assertAlmostEqual(result["final"]["x"][0], 0.8, delta=0.05)
        before = [row for row in zip(result["trajectory"]["t"], result["trajectory"]["x"]) if row[0] < 1.0]
        self.assertTrue(all(abs(x[0]) < 1e-9 and abs(x[1]) < 1e-9 for _, x in before))

    def test_sides_of_a_kink_are_no_other_solutions(self):
        result, _, _ = self.simulated(PWM.replace("+ pwm", "+ u"))
        held = result["events"][1]
        self.assertEqual(held["kind"], "enter_sliding")
        self.assertIsNot(held["unique"], False)
        self.assertAlmostEqual(held["alpha_after"][0], 0.44, delta=1e-7)

    def test_a_control_from_a_file_may_go_through_a_table(self):
        self.write("u.csv", "t,u\n0,0.25\n1,0.75\n")
        result, _, _ = self.simulated(TABLE_OF_INPUT)
        self.assertAlmostEqual(result["final"]["x"][0], 0.5 + 1.5, delta=1e-9)

    def test_functions_have_the_names_that_were_written(self):
        result, _, err = self.simulated(NAMES)
        self.assertEqual(err, "")
        self.assertEqual(result["switching_functions"], ["s", "x"])
        sliding = [event for event in result["events"] if event["kind"] == "enter_sliding"]
        self.assertEqual([event["surfaces"] for event in sliding], [["s"]])

    def test_definitions_are_recorded_under_their_names_and_angles_wrapped(self):
        result, _, _ = self.simulated(NAMES)
        self.assertEqual(result["outputs"], ["turns", "s", "turn"])
        turns, s, turn = result["final"]["outputs"]
        self.assertAlmostEqual(s, result["final"]["x"][0] - 0.5, delta=1e-9)
        self.assertEqual(turns, 2.0)  # 16 / (2 pi) = 2.546
        self.assertAlmostEqual(turn, 16 % 6.283185307179586, delta=1e-6)
        checked, _ = self.run_tool("check", "m.toml", code=0)
        self.assertRegex(checked, r"(?m)^  s = .*, recorded$")
        self.assertNotIn("s = s", checked)
        stated = [entry for entry in result["model"]["equations"] if entry["left"] == "s"]
        self.assertEqual(stated, [{"left": "s", "right": "x - 0.5", "where": "output"}])
        same = NAMES.replace('record = ["s", "turn"]', 's = "s"\nturn = "turn"')
        self.assertEqual(self.simulated(same)[0]["final"]["outputs"], result["final"]["outputs"])
        self.write("m.toml", NAMES.replace('record = ["s", "turn"]', 'record = ["s", "s"]'))
        _, err = self.run_tool("check", "m.toml", code=2)
        self.assertIn("'s' is recorded twice", err)
        self.write("m.toml", NAMES.replace('record = ["s", "turn"]', 's = "x"'))
        self.assertIn("'s' is already a definition", self.run_tool("simulate", "m.toml", code=2)[1])
        self.write("m.toml", NAMES.replace('"s", "turn"]', '"S"]'))
        self.assertIn("did you mean 's'?", self.run_tool("simulate", "m.toml", code=2)[1])
        # Where it decides something it is refused as before.
        self.write("m.toml", NAMES.replace("th = 4", 'th = "turn"'))
        self.assertIn("floor and mod are for the time", self.run_tool("simulate", "m.toml", code=2)[1])

    def test_a_jump_may_be_called_like_a_state(self):
        result, _, _ = self.simulated(RELAY)
        self.assertEqual([event["name"] for event in result["events"]], ["off", "on", "off"])
        self.write("m.toml", RELAY.replace('name = "off"', 'name = "on"'))
        self.assertIn("on", self.run_tool("simulate", "m.toml", code=2)[1])

    def test_a_dose_is_given_at_the_time_that_was_set_for_it(self):
        for integrator in ("dopri5", "dop853", "radau5", "taylor"):
            result, _, _ = self.simulated(DOSES, "--integrator", integrator, "--rtol", "1e-9", "--atol", "1e-11")
            final = dict(zip(result["states"], result["final"]["x"]))
            self.assertEqual((final["doses"], final["held"]), (7, 0))
            self.assertAlmostEqual(final["A"], 0.13533901, delta=1e-7)  # SciPy, with the rule in Python
            self.assertAlmostEqual(final["Circ"], 4.59356115, delta=1e-6)

    def test_cycles_on_their_way_to_a_limit_cycle_have_no_limit(self):
        # Where the valve leaves its friction the velocity has no rate: that resolves its cycles all the same.
        for integrator in ("dopri5", "dop853", "radau5"):
            for until in ("20", "60", "150"):
                result, _, _ = self.simulated(VALVE, "--integrator", integrator, "--until", until)
                self.assertEqual(result["status"]["termination"], "completed")
                self.assertNotIn("accumulation", [event["kind"] for event in result["events"]])

    def test_the_layer_that_is_advised_resolves_the_cycles(self):
        _, _, err = self.simulated(FEEDBACK, code=3)
        epsilon = err.split("simulate.smoothed.epsilon = ")[1].split(",")[0]
        result, _, err = self.simulated(FEEDBACK, "--method", "smoothed", "--set", f"simulate.smoothed.epsilon={epsilon}")
        self.assertEqual(result["status"]["termination"], "completed")
        _, _, err = self.simulated(FEEDBACK, "--method", "smoothed", "--set", "simulate.smoothed.epsilon=1e-9", code=3)
        self.assertIn("a wider layer: simulate.smoothed.epsilon = ", err)
        self.assertNotIn('method = "smoothed"', err)

    def test_the_end_of_the_steps_is_no_end_of_the_advice(self):
        _, _, err = self.simulated(FEEDBACK, "--set", "simulate.max_steps=1500", code=3)
        self.assertIn("max_steps = 1500 reached", err)
        self.assertIn('use method = "smoothed" with simulate.smoothed.epsilon = ', err)
        _, _, err = self.simulated(FEEDBACK, "--set", "simulate.max_steps=3", "--integrator", "dopri5", code=3)
        self.assertIn("raise simulate.max_steps if they are meant, or try --integrator radau5", err)

    def test_the_layer_that_is_advised_is_not_too_thin(self):
        _, _, err = self.simulated(SLIDING_CONTROL, code=3)
        epsilon = err.split("simulate.smoothed.epsilon = ")[1].split(",")[0]
        result, _, _ = self.simulated(SLIDING_CONTROL, "--method", "smoothed", "--set",
                                      f"simulate.smoothed.epsilon={epsilon}")
        self.assertLess(result["statistics"]["steps"], 100_000)

    def test_a_puck_comes_to_rest(self):
        result, _, _ = self.simulated(PUCK)
        (stick,) = result["events"]
        self.assertEqual((stick["kind"], stick["surfaces"]), ("stick", ["friction of vx, vy"]))
        self.assertAlmostEqual(stick["t"], 13**0.5 / (0.3 * 9.81), delta=1e-7)
        self.assertEqual(result["final"]["x"][2:], [0.0, 0.0])

    def test_an_input_may_move_the_belt_under_a_puck(self):
        belt = PUCK.replace("vx/speed", "(vx - belt)/speed").replace("hypot(vx", "hypot(vx - belt")
        belt = belt.replace("[states]", "[controls]\nbelt = 0\n[states]")
        self.write("belt.csv", "t,belt\n0,0\n2,1\n")
        for written in ('"if(t > 2, 1, 0)"', '{ file = "belt.csv" }'):
            result, _, _ = self.simulated(belt + f"inputs = {{ belt = {written} }}\n")
            self.assertEqual([event["kind"] for event in result["events"]], ["stick", "slip", "stick"])
            self.assertAlmostEqual(result["events"][2]["t"], 2 + 1 / (0.3 * 9.81), delta=1e-7)
            self.assertEqual(result["final"]["x"][2:], [1.0, 0.0])

    def test_planar_friction_of_another_form_is_named(self):
        _, _, err = self.simulated(PUCK.replace("-mu*9.81", "-(mu + 0.01*vx^2)*9.81"), code=3)
        self.assertIn("a norm of vx, vy vanishes here", err)
        self.assertIn("sqrt(vx^2 + vy^2 + 1e-6)", err)

    def test_finite_elements_say_that_a_norm_vanishes(self):
        _, _, err = self.simulated(PUCK, "--method", "fesd", "--set", "simulate.max_steps=2000", code=3)
        self.assertIn("a norm of vx, vy vanishes here", err)
        self.assertIn('or method = "event"', err)

    def test_a_unit_behind_a_number_is_understood(self):
        for written, unit in (("1 [m]", "m"), ("9.81 m/s^2", "m/s^2"), ("300 K # warm", "K")):
            self.write("m.toml", PUCK.replace("x = 0", f"x = {written}", 1))
            _, err = self.run_tool("simulate", "m.toml", code=2)
            self.assertIn(f'unit = "{unit}" }}', err)

    def test_a_model_file_beside_is_offered(self):
        self.write("puck.toml", PUCK)
        self.assertIn("did you mean the file puck.toml?", self.run_tool("simulate", "puck", code=2)[1])

    def test_tolerances_below_rounding_are_told(self):
        _, err = self.run_tool("simulate", "stick-slip", "--rtol", "1e-20", "--atol", "1e-20", "--set",
                               "simulate.max_steps=10", code=3)
        self.assertIn("more digits than numbers have", err)


class Colours(tool.ToolTest):
    def on_a_terminal(self, **environment):
        import os
        import pty
        import subprocess
        seen, shown = pty.openpty()
        process = subprocess.Popen([tool.TOOL, "simulate", "none"], stderr=shown, stdout=subprocess.DEVNULL,
                                   env=os.environ | {"TERM": "xterm"} | environment)
        self.assertEqual(process.wait(timeout=tool.WAIT), 2)
        os.close(shown)
        text = os.read(seen, 4096).decode()
        os.close(seen)
        return text

    def test_only_on_terminals_and_where_they_are_wanted(self):
        self.assertIn("\x1b[1;31merror:\x1b[0m", self.on_a_terminal(NO_COLOR=""))
        self.assertNotIn("\x1b", self.on_a_terminal(NO_COLOR="1"))
        self.assertNotIn("\x1b", self.on_a_terminal(NO_COLOR="", TERM="dumb"))
        self.assertNotIn("\x1b", self.run_tool("simulate", "none", code=2)[1])


class Editors(tool.ToolTest):
    def test_completion(self):
        import shutil
        import subprocess
        for shell in ("bash", "zsh", "fish"):
            script, _ = self.run_tool("completion", shell, code=0)
            for word in ("simulate", "--integrator" if shell != "fish" else "integrator", "diff"):
                self.assertIn(word, script)
            self.assertNotIn("options-page", script)
            if shutil.which(shell) and shell != "fish":
                path = self.write("script", script)
                subprocess.run([shell, "-n", path], check=True)
        self.assertIn("did you mean 'fish'?", self.run_tool("completion", "fisch", code=2)[1])

    def test_the_manual_page_has_every_command(self):
        page, _ = self.run_tool("man-page", code=0)
        for word in (".SS simulate", ".SS diff", "\\fB\\-\\-integrator", "SALTUS_CACHE"):
            self.assertIn(word, page)
        self.assertNotIn("options", page.split(".SS")[1].split("\n")[0])

    def test_bash_completes_names_of_parameters(self):
        import os
        import subprocess
        script, _ = self.run_tool("completion", "bash", code=0)
        self.write("script", script)
        self.write("m.toml", PUCK.replace("[simulate]", "[simulat]"))  # a broken model is read as far as it goes
        environment = os.environ | {"PATH": f"{os.path.dirname(tool.TOOL)}:{os.environ['PATH']}"}

        def completed(*words):
            line = "; ".join(["source ./script", f"COMP_WORDS=({' '.join(words)})", f"COMP_CWORD={len(words) - 1}",
                              "_saltus 2>/dev/null", 'printf "%s\\n" "${COMPREPLY[@]}"'])
            done = subprocess.run(["bash", "-c", line], cwd=self.folder, capture_output=True, text=True, env=environment,
                                  check=True)
            return done.stdout.split()
        self.assertEqual(completed("saltus", "sim"), ["simulate"])
        self.assertIn("stick-slip", completed("saltus", "simulate", "stick"))
        self.assertEqual(completed("saltus", "simulate", "m.toml", "--set", "m"), ["mu="])
        self.assertEqual(completed("saltus", "simulate", "--until", "3", "m.toml", "--set", "m"), ["mu="])
        self.assertIn("stick-slip", completed("saltus", "sweep", "stick"))
        self.assertEqual(completed("saltus", "sweep", "m.toml", "--over", "m"), ["mu="])
        self.assertEqual(completed("saltus", "new", "x", "--like", "g"), ["gene"])
        self.assertEqual(completed("saltus", "completion", "f"), ["fish"])
        self.assertEqual(completed("saltus", "simulate", "m.toml", "--integrator", "ta"), ["taylor"])
        self.assertEqual(completed("saltus", "help", "scr"), [])  # no file beside it, as "script"
        self.assertEqual(completed("saltus", "sweep", "m.toml", "--method", "f"), ["fesd"])
        self.assertIn("final", completed("saltus", "sweep", "m.toml", "--keep", "''"))
        self.assertIn("--rtol", completed("saltus", "simulate", "m.toml", "--rt"))


if __name__ == "__main__":
    tool.main()

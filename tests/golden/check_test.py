"""saltus check: what it understood of a model, or all its mistakes, without simulating."""

import json
import resource
import subprocess
import sys

import tool

TWO_MISTAKES = """[model]
name = "m"
[states]
x = "one"
[dynamics]
x = "-x"
[simulate]
until = "10 s"
"""

MANY = """[model]
name = "many"
[parameters]
k = 1
m = "2*kk"
k = 3
[states]
x = 1 [m]
v = { initial = 0, lower = "nothing" }
w = 0
[definitions]
spring = "-k*x +"
force = "spring + m"
a = "b"
b = "a"
[dynamics]
x = "v"
v = "force/m"
y = "a"
[[events]]
when = "velocity"
[[jumps]]
when = "x < 0"
set = { x = "-x", u = 1 }
[[jumps]]
when = "x + 1"
set = { x = 0 }
[simulat]
until = 1
"""

FRICTION = """[model]
name = "block"
description = "on a belt"
[parameters]
mu = { initial = 0.5, unit = "-", label = "friction" }
[states]
q = { initial = 1, unit = "m", label = "position" }
v = { initial = 0, unit = "m/s" }
on = 0
[definitions]
spring = "-q"
[switching]
slip = "v - 0.2"
[dynamics]
q = "v"
v = "spring - mu*sign(slip)*(1+on)"
on = 0
[outputs]
power = { value = "mu*sign(slip)*v", unit = "W", label = "lost" }
[[jumps]]
name = "harder"
when = "q < 0 and on == 0"
set = { on = 1 }
[[events]]
name = "turns"
when = "v"
[simulate]
until = 1e9
"""


JUMP = """
[model]
name = "m"
[states]
x = 1
[dynamics]
x = "-x"
[[jumps]]
when = "x < k"
set = { y = "z", x = "3*w" }
delay = "d"
"""


class Mistakes(tool.ToolTest):
    def check(self, text, *arguments, code=2):
        out, err = self.run_tool("check", self.write("m.toml", text), *arguments, code=code)
        return out, err.replace(f"{self.folder}/", "")

    def test_runs_show_the_line_of_their_first_mistake(self):
        file = self.write("m.toml", '[model]\nname = "m"\n[states]\nx = "one"\n[dynamics]\nx = "-x"\n[simulate]\nuntil = 1\n[optimize]\nhorizon = 1\ncontrol_intervals = 2\n')
        for command in ("simulate", "optimize"):
            _, err = self.run_tool(command, file, code=2)
            self.assertIn('\n    4 | x = "one"\n      |      ^\n', err, command)

    def test_all_at_once_with_line_and_caret(self):
        out, err = self.check(TWO_MISTAKES)
        self.assertEqual(out, "")
        first, second = err.index("m.toml:4:6: error: unknown name 'one'"), err.index("m.toml:8:9: error: until: ")
        self.assertLess(first, second)
        self.assertIn('\n    4 | x = "one"\n      |      ^\n', err)
        self.assertIn('\n    8 | until = "10 s"\n      |         ^\n', err)
        self.assertTrue(err.endswith("2 mistakes\n"), err)

    def test_warnings_of_one_kind_are_told_together_and_long_lists_shortened(self):
        unused = TWO_MISTAKES.replace('"one"', "1").replace('"10 s"', "1").replace(
            "[states]", "[parameters]\n" + "".join(f"p{i} = {i}\n" for i in range(30)) + "[states]")
        told = "m.toml:4: parameter 'p0' is never used (and 29 more like it: 'p1', 'p2', 'p3', …)"
        out, err = self.check(unused, code=0)
        self.assertTrue(out.replace(f"{self.folder}/", "").endswith(f"warnings (30)\n  {told}\n  (--json shows all)\n"), out)
        self.assertEqual(len(json.loads(self.check(unused, "--json", code=0)[0])["warnings"]), 30)
        _, err = self.run_tool("simulate", "m.toml", "--quiet", code=0)
        self.assertEqual(err, f"warning: {told}\n")
        jumps = "".join(f'[[jumps]]\nname = "j{i}"\nwhen = "x < {-i}"\nset = {{ x = 1 }}\n' for i in range(300))
        out, _ = self.check(unused + jumps, code=0)
        self.assertIn("jumps (300)\n  j0: ", out)
        self.assertIn("\n  … (276 more; --json shows all)\n  j296: ", out)

    def test_what_a_misspelt_key_was_to_be_is_not_missing(self):
        for text, key in ((TWO_MISTAKES.replace("name =", "nane ="), "nane"),
                          (TWO_MISTAKES + '[[hysteresis]]\nname = "h"\ninput = "x"\nupper = 1\nlower = 0\n', "upper"),
                          (TWO_MISTAKES + '[[events]]\nwen = "x"\n', "wen")):
            with self.subTest(key):
                _, err = self.check(text)
                self.assertIn(f"unknown key '{key}'", err)
                self.assertNotRegex(err, "has no|no table")

    def test_an_entry_with_an_unknown_key_is_not_judged_further(self):
        plain = "[model]\nname = 'm'\n[states]\nx = 1\nv = 0\n[dynamics]\nx = 'v'\nv = '-x'\n"
        switched = plain.replace("'-x'", "'-x + relay'")
        fallen = plain.split("[dynamics]")[0] + "[mechanics]\npositions = ['x']\nvelocities = ['v']\nmass = [[1]]\n"
        tables = {"[[jumps]]": (plain, {"when": "'x < 0'", "set": "{ v = '-v' }"}),
                  "[[events]]": (plain, {"when": "'x'"}),
                  "[[hysteresis]]": (switched, {"name": "'relay'", "input": "'x'", "on": "1", "off": "0.5"}),
                  "[[contacts]]": (fallen, {"name": "'floor'", "gap": "'x'", "restitution": "0.5"}),
                  "[mechanics]": (plain.split("[dynamics]")[0], {"positions": "['x']", "velocities": "['v']", "mass": "[[1]]"}),
                  "[[modes]]": (plain.split("[dynamics]")[0], {"when": "'otherwise'", "dynamics": "{ x = 'v', v = '-x' }"})}
        for table, (head, keys) in tables.items():
            for wrong in keys:
                with self.subTest(f"{table} {wrong}"):
                    lines = [f"{key}_ = {value}" if key == wrong else f"{key} = {value}" for key, value in keys.items()]
                    _, err = self.check(head + table + "\n" + "\n".join(lines) + "\n[simulate]\nuntil = 1\n")
                    self.assertIn(f"unknown key '{wrong}_'", err)
                    self.assertEqual(err.count(": error: "), 1, err)

    def test_every_entry_is_judged_by_itself(self):
        jumps = "[[jumps]]\nwen = 'x < 0'\nset = { x = 1 }\n[[jumps]]\nwhen = 'x > 1'\n"
        _, err = self.check("[model]\nname = 'm'\n[states]\nx = 1\n[dynamics]\nx = 0\n" + jumps)
        self.assertIn("unknown key 'wen'", err)
        self.assertIn("this jump has no `set`", err)
        self.assertTrue(err.endswith("2 mistakes\n"), err)

        head = "[model]\nname = 'm'\n[states]\nx = 1\n[dynamics]\nx = 0\n"
        tables = "[tables.a]\nx = [0, 1]\nyy = [0, 1]\n[tables.b]\nx = [0, 1]\n"
        squares = "[optimize]\nhorizon = 1\ncontrol_intervals = 2\n" + (
            "[[optimize.least_squares]]\nfo = ['x']\n[[optimize.least_squares]]\nreference = [1]\n")
        for text, told in ((tables, ["unknown key 'yy'", "table 'b' has no y"]),
                           (squares, ["unknown key 'fo'", "this table has no `of`"])):
            _, err = self.check(head + text + "[simulate]\nuntil = 1\n")
            self.assertTrue(err.endswith("2 mistakes\n") and all(part in err for part in told), err)

    def test_what_stands_in_a_line_without_readable_name_is_not_missing(self):
        head = "[model]\nname = 'm'\n[states]\nx = 1\n[dynamics]\n"
        for text in (head + "dx/dt = '-x'\n", head + "dx/dt = -x\n", head.replace("x = 1", "x(0) = 1") + "x = '-x'\n",
                     head + "x = 0\n[[jumps]]\nwh en = 'x < 0'\nset = { x = 1 }\n",
                     head.replace("[states]", "[parameters]\nk k = 1\n[states]") + "x = '-kk*x'\n"):
            with self.subTest(text):
                _, err = self.check(text + "[simulate]\nuntil = 1\n")
                self.assertEqual(err.count(": error: "), 1, err)

    def test_one_is_told_once_and_what_follows_from_it_is_not(self):
        _, err = self.check(MANY)
        places = [line.split(":")[1] for line in err.splitlines() if ": error: " in line]
        expected = ["5",   # kk
                    "6",   # k again
                    "8",   # 1 [m]
                    "9",   # nothing
                    "10",  # w has no right-hand side
                    "12",  # the sum ends
                    "15",  # a cycle
                    "19",  # y is no state
                    "21",  # velocity
                    "24",  # u is no state
                    "26",  # a guard without direction
                    "28"]  # [simulat]
        self.assertEqual(places, expected, err)

    def test_all_of_one_jump(self):
        _, err = self.check(JUMP)
        places = [line.split(":")[1:3] for line in err.splitlines() if ": error: " in line]
        self.assertEqual(places, [["9", "13"], ["10", "9"], ["10", "14"], ["10", "25"], ["11", "10"]], err)
        self.assertEqual(err.count("in [[jumps]]"), 5)

    def test_what_is_missing_does_not_end_the_search(self):
        head = "[model]\nname = 'm'\n[states]\nx = 1\nv = 0\n"
        rates = "[dynamics]\nx = 'v'\nv = '-x'\n"
        for text, told in ((head + rates + "[[events]]\nname = 'a'\n", "no `when`"),
                           (head + rates + "[[hysteresis]]\nname = 'h'\ninput = 'x'\non = 1\n", "no `off`"),
                           (head + "[mechanics]\npositions = ['x']\nvelocities = ['v']\n[[contacts]]\nname = 'c'\n", "no `gap`"),
                           # What follows from a mistake is silent, and stated in no part.
                           (head + "[switching]\ns = 1970-01-01\n" + rates + "[[modes]]\nwhen = 's > 0'\n"
                            "dynamics = { x = 1 }\n", "expected a number or an expression")):
            _, err = self.check(text)
            self.assertIn(told, err)
            self.assertNotIn("error: \n", err)

    def test_a_rate_that_cannot_be_read_is_not_missing(self):
        _, err = self.check("[model]\nname = 'm'\n[states]\nx = 1\nv = '2 m/s'\n[dynamics]\nx = 'v'\nv = '-9.81 m/s^2'\n")
        self.assertIn("2 mistakes", err)
        self.assertIn("units are no part of expressions", err)

    def test_options_that_do_not_fit(self):
        _, err = self.check("[model]\nname = 'm'\n[states]\nx = 1\n[dynamics]\nx = '-x'\n[simulate]\nuntil = -1\n")
        self.assertIn("until (-1) is not after from (0)", err)
        self.assertIn("until = -1\n", err)

    def test_a_mistake_in_a_setting_is_told_as_before(self):
        path = self.write("m.toml", FRICTION)
        _, err = self.run_tool("check", path, "--set", "mi=1", code=2)
        self.assertIn("did you mean 'mu'?", err)
        _, err = self.run_tool("check", path, "--set", "dynamics.v=q+", code=2)
        self.assertIn("dynamics.v", err)
        self.assertNotIn("mistakes", err)

    def test_standard_input_has_carets_too(self):
        done = subprocess.run([tool.TOOL, "check", "-"], input=TWO_MISTAKES, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn('<standard input>:4:6: error: unknown name', done.stderr)
        self.assertIn('    4 | x = "one"\n      |      ^\n', done.stderr)

    def test_for_programs(self):
        out, err = self.check(TWO_MISTAKES, "--json")
        report = json.loads(out)
        self.assertEqual((report["format"], report["valid"]), ("saltus-check/1", False))
        self.assertEqual([(e["line"], e["column"]) for e in report["errors"]], [(4, 6), (8, 9)])
        self.assertIn("unknown name 'one'", report["errors"][0]["message"])
        self.assertNotIn("states", report)


class Overview(tool.ToolTest):
    def test_shows_equations_surfaces_jumps_and_units(self):
        out, err = self.run_tool("check", self.write("m.toml", FRICTION), code=0)
        self.assertEqual(err, "")
        for line in ("  q = 1 m  (position)", "  v = 0 m/s", "  mu = 0.5 -  (friction)", "  q' = v",
                     "  v' = spring - mu*sign(slip)*(1 + on)", "  spring = -q",
                     "  power = mu*sign(slip)*v  [W]  (lost)",
                     "  slip: v - 0.2 = 0; v' may jump there",
                     "  harder: when q < 0 and on == 0 becomes true; sets on: on becomes 1", "  turns: v"):
            self.assertIn(line, out.splitlines())

    def test_specialists_ask_for_more(self):
        text = ('[model]\nname = "m"\n[parameters]\ntop = 2\n[states]\nx = 1\n[dynamics]\n'
                'x = "min(max(x, -top), top) - sign(x)"\n[simulate]\nuntil = 1\n')
        plain, _ = self.run_tool("check", self.write("m.toml", text), code=0)
        self.assertIn("  x + top = 0; x' has a corner there: the integrator restarts, nothing slides", plain.splitlines())
        self.assertIn("  x = 0; x' may jump there", plain.splitlines())
        for word in ("multi-affine", "inclusion", "--", "kink"):
            self.assertNotIn(word, plain)
        in_depth, _ = self.run_tool("check", "m.toml", "--well-posedness", code=0)
        self.assertIn("multi-affine in the selections", in_depth)

    def test_for_programs(self):
        out, _ = self.run_tool("check", self.write("m.toml", FRICTION), "--json", code=0)
        report = json.loads(out)
        self.assertTrue(report["valid"])
        self.assertEqual([state["name"] for state in report["states"]], ["q", "v", "on"])
        self.assertEqual(report["states"][0]["unit"], "m")
        self.assertEqual(report["outputs"][0]["label"], "lost")
        self.assertEqual(report["surfaces"][0]["rates"], ["v"])
        self.assertEqual(report["jumps"][0]["set"], [{"name": "on", "expression": "1"}])
        out, _ = self.run_tool("check", "stick-slip", "--json", code=0)
        self.assertEqual(json.loads(out)["complementarity_systems"], [
            {"form": "step", "n_alpha": 1, "n_theta": 2, "n_beta": 0, "n_alg": 5, "n_comp": 2, "n_eq": 3},
            {"form": "stewart", "n_alpha": 0, "n_theta": 2, "n_beta": 0, "n_alg": 5, "n_comp": 2, "n_eq": 3}])
        out, _ = self.run_tool("check", "bouncing-ball", "--json", code=0)
        self.assertIn("[[jumps]]", json.loads(out)["complementarity_systems"][0]["reason"])
        out, _ = self.run_tool("check", "turbo-car", "--json", code=0)
        self.assertGreater(json.loads(out)["optimization"]["problem"]["variables"], 100)

    def test_every_model_of_the_catalogue_has_a_json(self):
        for path in sorted((tool.SOURCE / "models").rglob("*.toml")):
            out, _ = self.run_tool("check", path, "--json", code=0)
            report = json.loads(out)
            self.assertEqual((report["errors"], report["valid"]), ([], True), path)
            self.assertTrue(report["equations"] or report["modes"], path)

    def test_simulates_nothing(self):
        # The simulation of this model would take hours.
        path = self.write("m.toml", FRICTION.replace('"spring', '"sin(1e6*t) + spring'))
        begin = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        self.run_tool("check", path, code=0)
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - begin, 1.0)

    def test_ranks_are_there_for_the_asking(self):
        plain, _ = self.run_tool("check", "two-belts", code=0)
        self.assertNotIn("rank", plain)
        self.assertNotIn("complementarity", plain)
        more, _ = self.run_tool("check", "two-belts", "--well-posedness", code=0)
        self.assertTrue(more.startswith(plain))
        self.assertIn("rank 2 of 2", more)


if __name__ == "__main__":
    tool.main()

"""Drawings without a browser: saltus report --figure, --phase, --open."""

import json
import math
import os
import pathlib
import re
import stat
import time
import xml.etree.ElementTree as tree

import tool

SERVO = """[model]
name = "servo"
[states]
angle = 0
speed = 0
[[hysteresis]]
name = "forward"
input = "1 - angle"
on = 0.10
off = 0.06
initial = 1
[[hysteresis]]
name = "backward"
input = "angle - 1"
on = 0.10
off = 0.06
[dynamics]
angle = "speed"
speed = "60*(forward - backward) - 5*speed"
[outputs]
u = "6*(forward - backward)"
[simulate]
until = 10
"""

class Figure(tool.ToolTest):
    def setUp(self):
        super().setUp()
        self.run_tool("simulate", "stick-slip", "--out", "r.json", "--quiet", code=0)

    def words(self, name):
        svg = tree.parse(self.folder / name).getroot()
        return [text.text for text in svg.iter("{http://www.w3.org/2000/svg}text")]

    def test_over_time_and_in_a_plane(self):
        out, _ = self.run_tool("report", "r.json", "--figure", "time.svg", code=0)
        self.assertEqual(out, "time.svg\n")
        self.assertFalse((self.folder / "r.html").exists())
        for name in ("q", "v", "slip", "alpha(slip)", "t"):
            self.assertIn(name, self.words("time.svg"))
        self.run_tool("report", "r.json", "--figure", "plane.svg", "--phase", "t,alpha(slip)", code=0)
        self.assertIn("stick-slip: alpha(slip) over t", self.words("plane.svg"))

    def marks(self, name, kind, key, value):
        svg = tree.parse(self.folder / name).getroot()
        return [mark for mark in svg.iter(f"{{http://www.w3.org/2000/svg}}{kind}") if mark.get(key) == value]

    def test_columns_over_time_can_be_chosen(self):
        self.run_tool("report", "r.json", "--figure", "a.svg", "--columns", "alpha(slip),q", code=0)
        words = self.words("a.svg")
        self.assertLess(words.index("alpha(slip)"), words.index("q"))
        self.assertNotIn("v", words)

    def test_a_plane_of_two_states_has_its_field_and_the_events(self):
        self.run_tool("report", "r.json", "--figure", "a.svg", "--phase", "q,v", code=0)
        self.assertGreater(len(self.marks("a.svg", "path", "stroke", "#b9c0ca")), 100)
        self.assertGreater(len(self.marks("a.svg", "circle", "fill", "#8d97a5")), 0)
        self.run_tool("report", "r.json", "--figure", "a.svg", "--phase", "t,v", code=0)
        self.assertEqual(self.marks("a.svg", "path", "stroke", "#b9c0ca"), [])

    def test_jumps_are_seen_without_rows_at_events(self):
        """Dotted lines from the state before an event to that behind it, and none through it."""
        rows = ("--set", "simulate.until=3", "--set", "simulate.output.every=0.1")
        self.run_tool("simulate", "bouncing-ball", *rows, "--out", "a.json", "--quiet", code=0)
        self.run_tool("simulate", "bouncing-ball", *rows, "--set", "simulate.output.events=false", "--out", "b.json", "--quiet", code=0)
        jumps = []
        for name in ("a", "b"):
            self.run_tool("report", f"{name}.json", "--figure", f"{name}.svg", "--columns", "v", code=0)
            jumps.append([mark.get("d") for mark in self.marks(f"{name}.svg", "path", "stroke-dasharray", "2 3")])
        self.assertEqual(len(jumps[0]), 1)
        self.assertEqual(jumps[0], jumps[1])

    def test_events_closer_than_their_lines_have_none(self):
        """Some of them at equal distances would look like a slower switching."""
        self.write("fast.toml", "[model]\nname = \"fast\"\n[states]\nx = 1\nv = 0\n[dynamics]\nx = \"v\"\n"
                   "v = \"if(t < 1, 0, -1e6*x)\"\n[outputs]\nu = \"sign(x)\"\n[simulate]\nuntil = 3\n")
        self.run_tool("simulate", "fast.toml", "--out", "r.json", "--quiet", code=0)
        events = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["events"]
        self.assertGreater(len(events), 500)
        self.run_tool("report", "r.json", "--figure", "a.svg", code=0)
        lines = [mark for mark in self.marks("a.svg", "path", "stroke", "#8d97a5") if mark.get("stroke-width") == "0.6"]
        self.assertLess(len(lines), 3)

    def test_edges_of_a_relay_are_all_drawn_alike(self):
        """Rows closer than pixels do not join the sides of a jump; legends tell its thresholds apart."""
        self.write("servo.toml", SERVO)
        self.run_tool("simulate", "servo.toml", "--out", "s.json", "--quiet", code=0)
        self.run_tool("report", "s.json", "--figure", "a.svg", "--columns", "u", code=0)
        jumps = json.loads((self.folder / "s.json").read_text())["events"]
        self.assertGreater(len(jumps), 50)
        self.assertEqual(len(self.marks("a.svg", "path", "stroke-dasharray", "2 3")), len(jumps))
        self.assertEqual(len(self.marks("a.svg", "path", "stroke-width", "1.6")), len(jumps) + 1)
        self.run_tool("report", "s.json", "--figure", "b.svg", "--phase", "angle,speed", code=0)
        thresholds = {"forward on": 0.9, "forward off": 0.94, "backward on": 1.1, "backward off": 1.06}
        for name in thresholds:
            self.assertEqual(self.words("b.svg").count(name), 1)
        self.assertEqual(self.thresholds("s.json", "angle"), thresholds)
        self.run_tool("simulate", "temperature-control", "--out", "t.json", "--quiet", code=0)
        self.assertEqual(self.thresholds("t.json", "y"), {"heating on": 18, "heating off": 20})

    def test_thresholds_of_jumps_that_turn_a_state_are_told_apart(self):
        """Whoever wrote them, in whatever order; other jumps keep their names."""
        model = ("[model]\nname = 'm'\n[states]\nT = 15\n{0} = 1\n[dynamics]\nT = '10*{0} - T'\n{0} = '0'\n[[jumps]]\nname = '{1}'\n"
                 "when = 'T < 8 and {0} < 0.5 or {0} > 0.5 and T > 9'\nset = {{ {0} = '{2}' }}\n[simulate]\nuntil = 5\n")
        for state, jump, value, expected in (("heat", "heat", "1 - heat", {"heat on": 8, "heat off": 9}),
                                             ("heat", "turn", "1 - heat", {"turn": 9}),
                                             ("heat", "heat", "2 - heat", {"heat": 9})):
            self.write("m.toml", model.format(state, jump, value))
            self.run_tool("simulate", "m.toml", "--out", "m.json", "--quiet", code=0)
            self.assertEqual(self.thresholds("m.json", "T"), expected)

    def thresholds(self, name, state):
        """Of every surface of this state alone where it lies."""
        surfaces = json.loads((self.folder / name).read_text())["surfaces"]
        lines = {one["name"]: one["affine"] for one in surfaces if one["states"] == [state]}
        return {name: round(-line["constant"] / line["gradient"][0], 12) for name, line in lines.items()}

    def test_units_and_labels_stand_beside_panels_and_axes(self):
        self.run_tool("new", "u", "--like", "impact", code=0)
        self.run_tool("simulate", "u.toml", "--out", "u.json", "--quiet", code=0)
        self.run_tool("report", "u.json", "--figure", "a.svg", code=0)
        for word in ("h [m]", "height", "v [m/s]", "velocity", "energy [J/kg]"):
            self.assertIn(word, self.words("a.svg"))
        self.run_tool("report", "u.json", "--figure", "a.svg", "--phase", "h,v", code=0)
        self.assertIn("height h [m]", self.words("a.svg"))
        self.assertIn("velocity v [m/s]", self.words("a.svg"))
        out, _ = self.run_tool("simulate", "u.toml", code=0)
        self.assertRegex(out, r"(?m)^where +h: height  v: velocity$")

    def test_results_are_drawn_over_each_other(self):
        self.run_tool("simulate", "stick-slip", "--until", "25", "--set", "belt=0.3", "--out", "faster.json", "--quiet",
                      code=0)
        for words in ([], ["--phase", "q,v"]):
            self.run_tool("report", "r.json", "faster.json", "--figure", "a.svg", *words, code=0)
            self.assertIn("faster.json", self.words("a.svg"))
            lines = [line for line in self.marks("a.svg", "path", "stroke", "#e8590c") if line.get("clip-path") is None]
            self.assertGreater(len(lines), 1)  # of the curves, and of the legend
        self.run_tool("report", "r.json", "faster.json", "--figure", "a.svg", "--columns", "q", code=0)
        self.assertIn("25", self.words("a.svg"))  # the time of both

    def turns(self, name, color):
        """The angles in degrees by which a curve turns at its points, those at events (two points in one place) aside."""
        angles = []
        for line in self.marks(name, "path", "stroke", color):
            numbers = [float(number) for number in re.findall(r"-?[0-9.]+(?:e-?[0-9]+)?", line.get("d"))]
            points = list(zip(numbers[::2], numbers[1::2]))
            moves = [(c - a, d - b) for (a, b), (c, d) in zip(points, points[1:])]
            angles += [abs(math.degrees(math.atan2(a * d - b * c, a * c + b * d)))
                       for (a, b), (c, d) in zip(moves, moves[1:]) if min(math.hypot(a, b), math.hypot(c, d)) > 2.0]
        return angles

    def test_curves_in_a_plane_have_no_corners_of_their_own(self):
        ring = "[model]\nname = \"ring\"\n[states]\nx = 1\ny = 0\n[dynamics]\nx = \"y\"\ny = \"-x\"\n[simulate]\nuntil = 6\n"
        relay = ring.replace('"-x"', '"-sign(x) - x"')
        for text in (ring, relay):
            self.run_tool("simulate", self.write("m.toml", text), "--out", "m.json", "--quiet", code=0)
            self.run_tool("report", "m.json", "--figure", "a.svg", "--phase", "x,y", code=0)
            turns = self.turns("a.svg", "#1f66b0")
            self.assertGreater(len(turns), 60)
            self.assertLess(max(turns), 4.0)

    def test_what_is_wrong_is_refused_before_anything_is_written(self):
        self.run_tool("simulate", "crossing", "--out", "other.json", "--quiet", code=0)
        for arguments, part in ((["--figure", "a.gif"], ".svg, .pdf or .png"),
                                (["--figure", "a.svg", "--phase", "q,w"], "no column 'w'"),
                                (["--figure", "a.svg", "--phase", "q"], "two columns"),
                                (["--figure", "none/a.svg"], "none"),
                                (["other.json", "--figure", "a.svg"], "is a result of the model 'crossing'"),
                                (["--figure", "a.svg", "--columns", "q,w"], "no column 'w'"),
                                (["--figure", "a.svg", "--columns", "t"], "no column 't'"),
                                (["--figure", "a.svg", "--columns", "q", "--phase", "q,v"], "one of them"),
                                (["--columns", "q"], "--figure"),
                                (["--phase", "q,v"], "--figure")):
            _, err = self.run_tool("report", "r.json", *arguments, code=2)
            self.assertIn(part, err)
            self.assertFalse((self.folder / "a.svg").exists())

    def test_without_a_converter_only_svg_can_be_written(self):
        _, err = self.run_tool("report", "r.json", "--figure", "a.pdf", code=2, environment={"PATH": "/none"})
        self.assertIn("librsvg2-bin", err)

    def test_the_converter_makes_the_other_formats(self):
        if not any((pathlib.Path(folder) / "rsvg-convert").exists() for folder in os.environ["PATH"].split(":")):
            self.skipTest("no rsvg-convert")
        self.run_tool("report", "r.json", "--figure", "a.pdf", "--figure", "a.png", code=0)
        self.assertTrue((self.folder / "a.pdf").read_bytes().startswith(b"%PDF"))
        self.assertTrue((self.folder / "a.png").read_bytes().startswith(b"\x89PNG"))

    def test_open_gives_the_page_to_the_browser(self):
        browser = self.folder / "browser"
        browser.write_text("#!/bin/sh\necho \"$1\" > seen.tmp && mv seen.tmp seen\n", encoding="utf-8")
        browser.chmod(browser.stat().st_mode | stat.S_IXUSR)
        self.run_tool("report", "r.json", "--open", code=0, environment={"BROWSER": str(browser)})
        end = time.monotonic() + tool.WAIT
        while not (self.folder / "seen").exists() and time.monotonic() < end:
            time.sleep(0.02)
        self.assertEqual((self.folder / "seen").read_text(encoding="utf-8").strip(),
                         str((self.folder / "r.html").resolve()))
        out, err = self.run_tool("report", "r.json", "--open", code=0, environment={"BROWSER": "/none/browser"})
        self.assertEqual(out, "r.html\n")
        self.assertIn("r.html is written", err)
        self.assertIn("BROWSER", err)


class Overlays(tool.ToolTest):
    def test_results_of_other_models_are_refused(self):
        for model in ("stick-slip", "circle"):
            self.run_tool("simulate", model, "--out", f"{model}.json", "--quiet", code=0)
        _, err = self.run_tool("report", "stick-slip.json", "circle.json", "--out", "p.html", code=2)
        self.assertIn("circle.json", err)
        self.assertFalse((self.folder / "p.html").exists())
        _, err = self.run_tool("report", "stick-slip.json", "none.json", "--out", "p.html", code=2)
        self.assertIn("none.json", err)
        self.run_tool("report", "stick-slip.json", "stick-slip.json", "--out", "p.html", code=0)


if __name__ == "__main__":
    tool.main()

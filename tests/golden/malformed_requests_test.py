"""Requests that cannot be met: command lines, settings, files to read and to write, right-hand sides that are no numbers.
Each ends with exit code 2 (or 3 where the numerics stop), a message that helps, and with earlier results as they were."""

import json
import os
import re
import subprocess

import tool
from malformed import base

EARLIER = b'{"an": "earlier result"}'


class RequestTest(tool.ToolTest):
    def setUp(self):
        super().setUp()
        self.write("m.toml", base.GOOD)

    def refused(self, *arguments, message):
        """Exit code 2, nothing on standard output, the parts of the message, and no file more or less than before."""
        before = sorted(self.folder.rglob("*"))
        out, err = self.run_tool(*arguments, code=2)
        self.assertEqual(out, "")
        self.assertEqual(err.count("error: "), 1, err)
        for part in message:
            self.assertIn(part, err)
        self.assertEqual(sorted(self.folder.rglob("*")), before)


class Settings(RequestTest):
    CASES = {
        "": ["--set : ", "expected NAME=VALUE"],
        "=": ["expected NAME=VALUE"],
        "mu": ["--set mu: expected NAME=VALUE", "--set mu=0.5"],
        "mu=": ["--set mu=: expected NAME=VALUE"],
        "=3": ["expected NAME=VALUE"],
        "mu==3": ["--set mu==3", "'='"],
        "nu=3": ["--set nu", "expected the name of a parameter, a state or a control, found 'nu'", "did you mean 'mu'"],
        "mu=3 4": ["--set mu=3 4:1:3", "missing operator between '3' and '4'"],
        "mu=x": ["--set mu=x:1:1", "expected constants, found 'x', which is a state"],
        "mu=t": ["a constant cannot depend on the time t"],
        "mu=1/0": ["the value of 'mu' is inf, not a finite number"],
        "mu=1e999": ["beyond the range of double precision"],
        "mu=1 > 0": ["expected a number, found the condition"],
        "x.initial=1": ["'x' is no table of a model file", "known: "],
        "states.x.inital=1": ["'inital' is no part of 'x'", "initial, lower and upper"],
        "states.y=1": ["the model has no 'y' there", "known: x, v"],
        "dynamics=1": ["found 'dynamics', which is not in the model"],
        "states=1": ["'states' is an option, no name of the model", "write simulate.output.states=1"],
        "integrator=radau5": ["--set integrator=radau5: error: 'integrator' is an option, no name of the model",
                              "write simulate.event.integrator=radau5"],
        "until=3": ["'until' is an option", "write simulate.until=3"],
        "scheme=x": ["write simulate.fesd.scheme=x or simulate.timestepping.scheme=x"],
        "event.integrator=radau5": ["'event' is a table of [simulate]", "write simulate.event.integrator"],
        "states.=1": ["the model has no '' there"],
        ".x=1": ["'' is no table of a model file"],
        "outputs.o=1": ["the model has no 'o' there", "adds nothing"],
        "state.x=1": ["'state' is no table of a model file", "did you mean 'states'"],
        "modes.0.when=x > 0": ["--set modes.0.when", "nothing in 'modes' can be set on the command line",
                               "write a parameter there"],
        "events.e.when=x": ["nothing in 'events' can be set"],
        "mechanics.mass=1": ["nothing in 'mechanics' can be set"],
        "model.nam=1": ["[model] has no key 'nam'", "did you mean 'name'"],
        "dynamics.x=sin(": ["--set dynamics.x:1:5", "expected"],
        "dynamics.x=w": ["--set dynamics.x:1:1", "unknown name 'w'"],
        "simulate=1": ["found 'simulate', which is not in the model"],
        "simulate.rtol=": ["expected NAME=VALUE"],
        "simulate.rtol=tight": ["--set simulate.rtol", "expected a finite number > 0, found \"tight\""],
        "simulate.rtol=-1": ["found -1"],
        "simulate.rtl=1": ["did you mean 'simulate.rtol'"],
        "simulate.until=0": ["until (0) is not after from (0)"],
        "simulate.output.every=1e-12": ["1e+12 rows", "a larger interval"],
        "simulate.output.times=[1, 0]": ["found 0 at place 2, after 1"],
        "simulate.output.times=[0, x]": ["expected a list of finite, increasing numbers"],
        "simulate.fesd.stages=half": ["expected a whole number >= 1, found \"half\""],
        "simulate.timestepping.step_equilibration=exact": ['expected "direct", "mlcp", "none"', 'found "exact"'],
        "simulate.event.integrator=ode45": ['expected "auto", "dopri5", "dop853", "radau5", "radau9", "radau13" or "taylor", found "ode45"'],
        "simulate.initial_mode.w=1": ["unknown switching function 'w'", "known: v"],
        "simulate.inputs.u=sin(t)": ["expected the name of a control, found 'u'", "declare it in [controls]"],
        "simulate.inputs.u=sin(": ["--set simulate.inputs.u:1:5"],
    }

    def test_all(self):
        for setting, message in self.CASES.items():
            with self.subTest(setting):
                self.refused("simulate", "m.toml", "--set", setting, "--out", "r.json", message=message)


class CommandLine(RequestTest):
    CASES = {
        ("sweep", "m.toml", "--over", "mu=1..5"): ["--over mu=1..5: error: expected values with commas between, or FROM:TO:NUMBER"],
        ("sweep", "m.toml", "--over", "mu=[1,2]"): ["--over mu=[1: error: expected values with commas", "--over k=1,2,4"],
        ("sweep", "m.toml", "--over", "mu=1 2"): ["--over mu=1 2: error: expected values with commas"],
        ("sweep", "m.toml", "--over", "nu=1,2"): ["--over nu=1: error: ", "found 'nu'", "did you mean 'mu'?"],
        ("sweep", "m.toml", "--over", "mu=1,2"): ["--out is missing"],
        ("sweep", "m.toml", "--over", "mu=1 + 2,1 - 0.5"): ["--out is missing"],
        ("sweep", "m.toml", "--over", "simulate.inputs.u.file=../u.csv,u.csv"): ["../u.csv: error: there is no such file"],
        ("options",): ["'options' is no command of saltus", "known: help, simulate"],
        ("settings",): ["'settings' is no command of saltus", "known: help, simulate"],
        ("solver",): ["'solver' is no command of saltus", "known: help, simulate"],
        ("simulat", "m.toml"): ["'simulat' is no command of saltus", "did you mean 'simulate'"],
        ("m.toml",): ["'m.toml' is no command of saltus", "did you mean `saltus simulate m.toml`?"],
        ("nonsense",): ["'nonsense' is no command of saltus", "known: help, simulate"],
        ("simulate",): ["MODEL is required", "saltus simulate --help"],
        ("simulate", "m.toml", "m.toml"): ["unexpected argument 'm.toml'"],
        ("simulate", "m.toml", "--untl", "1"): ["unexpected argument '--untl'", "did you mean '--until'"],
        ("simulate", "m.toml", "--engine", "fesd"): ["unexpected argument '--engine'", "did you mean '--method'?"],
        ("simulate", "m.toml", "--tend", "3"): ["unexpected argument '--tend'", "did you mean '--until'?"],
        ("simulate", "m.toml", "--sweep", "mu=0:1:3"): ["'--sweep'", "--over is an option of `saltus sweep`"],
        ("simulate", "m.toml", "mu=0.5"): ["unexpected argument 'mu=0.5'", "did you mean --set mu=0.5?"],
        ("sweep", "m.toml", "--sweep", "mu=0:1:3"): ["unexpected argument '--sweep'", "did you mean '--over'?"],
        ("sweep", "m.toml", "mu=0:1:3"): ["unexpected argument 'mu=0:1:3'", "did you mean --over mu=0:1:3?"],
        ("sweep", "m.toml", "--over", "nu=0:1:3", "--out", "t.csv"): ["--over nu=0: error: ", "did you mean 'mu'?"],
        ("simulate", "m.toml", "--until"): ["--until"],
        ("simulate", "m.toml", "--until", "soon"): ["--until soon: error: expected a finite number, found \"soon\""],
        ("simulate", "m.toml", "--until", "inf"): ["--until inf"],
        ("simulate", "m.toml", "--until", "nan"): ["--until nan"],
        ("simulate", "m.toml", "--until", "-1"): ["until (-1) is not after from (0)"],
        ("simulate", "m.toml", "--until=1,5"): ["--until 1,5"],
        ("simulate", "m.toml", "--rtol", "0"): ["--rtol 0: error: expected a finite number > 0, found 0"],
        ("simulate", "m.toml", "--method", "euler"): ['expected "event"', 'found "euler"'],
        ("simulate", "m.toml", "--integrator", "rk4"): ['"dopri5", "dop853", "radau5", "radau9", "radau13" or "taylor"', 'found "rk4"'],
        ("simulate", "m.toml", "--integrator", "RK45"): ['found "RK45"', "did you mean 'dopri5'?"],
        ("simulate", "m.toml", "--method", "radau5"): ['expected "event"', "did you mean the integrator radau5?"],
        ("simulate", "m.toml", "--quiet=maybe"): ["--quiet"],
        ("check", "m.toml", "--until", "1"): ["unexpected argument '--until'"],
        ("report",): ["RESULT is required"],
        ("models", "no-such-model"): ["'no-such-model' is no file and no model of the catalogue", "saltus models"],
    }

    def test_all(self):
        for arguments, message in self.CASES.items():
            with self.subTest(arguments):
                self.refused(*arguments, message=message)


class OtherFormats(RequestTest):
    """Files of other programs: what they are, and where to read what to do."""

    ZIP = "PK\x03\x04"
    CASES = {
        "m.yaml": ("# a model\nstates:\n  x: 1\n", "YAML", "coming-from.md"),
        "m.yml": ("---\nstates: {x: 1}\n", "YAML", "coming-from.md"),
        "m.py": ("#!/usr/bin/env python\nimport numpy as np\n", "a program of Python", "coming-from.md#scipys-solve_ivp"),
        "m.ipynb": ('{"cells": []}', "a notebook of Jupyter", "coming-from.md#scipys-solve_ivp"),
        "m.jl": ("using DifferentialEquations\n", "a program of Julia", "coming-from.md#julias-differentialequationsjl"),
        "m.wl": ("NDSolve[{x'[t] == -x[t]}, x, {t, 0, 1}]\n", "a program of Mathematica", "coming-from.md#mathematicas-ndsolve"),
        "m.m": ("function dx = f(t, x)\n", "a program of MATLAB", "coming-from.md#matlab-simulink-stateflow"),
        "m.slx": (ZIP, "a model of Simulink", "coming-from.md#matlab-simulink-stateflow"),
        "m.fmu": (ZIP, "an FMU", "coming-from.md#modelica"),
        "m.mo": ("model M\nend M;\n", "Modelica", "coming-from.md#modelica"),
        "m.sbml": ("<sbml/>", "SBML", "coming-from.md#sbml-tools-copasi-tellurium"),
        "m.xml": ('<?xml version="1.0"?><mujoco/>', "a robot's XML (MJCF, URDF or SDF)", "coming-from.md#drake-mujoco"),
        "m.ode": ("x' = -x\ndone\n", "a model of XPPAUT", "coming-from.md"),
        "m.nl": ("g3 1 1 0\n", "a problem of AMPL", "saltus mpcc reads it: see docs/foreign-mpcc.md"),
        "m.mod": ("var x;\n", "a model of AMPL", "AMPL writes it as .nl, for saltus mpcc"),
        "p.json": ('{"f_fun": "", "G_fun": ""}', "a problem with complementarities", "saltus mpcc reads it"),
        "m.json": ('{"a": 1}', "JSON", "a .json that saltus simulate --out has written"),
        "m.cpp": ("int main() {}\n", "a program of C++", "docs/embedding.md"),
        "m.csv": ("t,x\n0,1\n", "a table of numbers", "a model is a .toml file"),
    }

    def test_all(self):
        for name, (text, what, remedy) in self.CASES.items():
            self.write(name, text)
            with self.subTest(name):
                self.refused("check", name, message=[f"{name}: error: this is {what}, no model of Saltus\n", remedy])

    def test_headings_exist(self):
        page = (tool.SOURCE / "docs" / "coming-from.md").read_text(encoding="utf-8")
        headings = {re.sub(r"[^\w -]", "", line[3:]).lower().replace(" ", "-") for line in page.splitlines() if line.startswith("## ")}
        anchors = {remedy.partition("#")[2] for _, _, remedy in self.CASES.values()} - {""}
        self.assertLessEqual(anchors, headings)

    def test_a_model_may_have_any_ending(self):
        for name in ("m.yaml", "m.py", "m"):
            with self.subTest(name):
                self.run_tool("check", self.write(name, "# a model\n" + base.GOOD), code=0)


class Inputs(RequestTest):
    def test_a_folder_is_no_model(self):
        (self.folder / "f.toml").mkdir()
        self.refused("simulate", "f.toml", message=["f.toml: error: cannot read: this is a folder", "name a file in it"])
        self.refused("check", ".", message=["this is a folder"])

    def test_nothing_there(self):
        self.refused("simulate", "none.toml", message=["none.toml: error: there is no such file"])
        self.refused("simulate", "m.toml/m.toml", message=["m.toml/m.toml: error: cannot read: Not a directory"])
        os.symlink("nowhere", self.folder / "broken.toml")
        self.refused("simulate", "broken.toml", message=["broken.toml: error: there is no such file"])

    def test_a_name_longer_than_any_file_has(self):
        self.refused("simulate", "m" * 5000 + ".toml", message=["cannot read: File name too long"])

    def test_not_readable(self):
        (self.folder / "m.toml").chmod(0)
        if os.access(self.folder / "m.toml", os.R_OK):
            self.skipTest("the superuser reads everything")
        self.refused("simulate", "m.toml", message=["m.toml: error: cannot read: Permission denied"])

    def test_a_source_that_never_ends(self):
        self.refused("simulate", "/dev/zero", message=["/dev/zero: error: ", "cannot read"])

    def test_results_that_are_none(self):
        for content, message in {b"": "r.json", b"{}": "'format' is missing", b"[1, 2": "r.json", b"\x00\xff": "r.json",
                                 b'{"format": "saltus-result/9"}': "saltus-result/9",
                                 b"[" * 100_000: "r.json"}.items():
            with self.subTest(content[:20]):
                self.write("r.json", content)
                self.refused("report", "r.json", message=[message])
                self.assertEqual((self.folder / "r.json").read_bytes(), content)


class Outputs(RequestTest):
    def test_names(self):
        (self.folder / "d.json").mkdir()
        for out, message in {"r.txt": ["r.txt: the name must end in .json or .csv"], "r": ["must end in .json or .csv"],
                             "r.parquet": ["must end in .json or .csv", "Python writes .parquet files"],
                             ".json": ["must end in"], "": ["must end in"], "r.JSON": ["must end in .json or .csv"],
                             "d.json": ["d.json: error: cannot write: this is a folder"],
                             "none/r.json": ["there is no folder 'none'", "create it first"],
                             "m.toml/r.json": ["'m.toml' is not a folder"],
                             "r" * 300 + ".json": ["File name too long"]}.items():
            with self.subTest(out):
                self.refused("simulate", "m.toml", "--out", out, message=message)
        self.refused("simulate", "m.toml", "--report", "r.json", message=["must end in .html or .htm"])
        self.run_tool("simulate", "m.toml", "--quiet", "--out", "r.json", code=0)
        self.refused("report", "r.json", "--out", "h.pdf", message=["--out h.pdf", "must end in .html or .htm"])

    def test_the_input_is_no_output(self):
        self.write("m.json", base.GOOD)
        for out in ("m.json", "./m.json", str(self.folder / "m.json")):
            self.refused("simulate", "m.json", "--out", out, message=["named twice, or is the input"])
        os.symlink("m.json", self.folder / "link.json")
        self.refused("simulate", "m.json", "--out", "link.json", message=["named twice, or is the input"])
        self.assertEqual((self.folder / "m.json").read_text(encoding="utf-8"), base.GOOD)

    def test_one_output_twice(self):
        os.symlink("r.json", self.folder / "link.json")
        for second in ("r.json", "./r.json", "link.json"):
            self.refused("simulate", "m.toml", "--out", "r.json", "--out", second, message=["named twice"])

    def test_not_writable(self):
        self.write("r.json", EARLIER)
        (self.folder / "r.json").chmod(0o444)
        if os.access(self.folder / "r.json", os.W_OK):
            self.skipTest("the superuser writes everything")
        self.refused("simulate", "m.toml", "--out", "r.json", message=["r.json: error: cannot write: Permission denied"])
        self.assertEqual((self.folder / "r.json").read_bytes(), EARLIER)

    def test_devices(self):
        os.symlink("/dev/full", self.folder / "full.json")
        self.refused("simulate", "m.toml", "--out", "full.json", message=["cannot write: not a regular file"])

    def test_a_full_disk_leaves_the_earlier_file(self):
        # A limit on the size of files is what a full disk is to write(2).
        self.write("r.json", EARLIER)
        script = 'trap "" XFSZ; ulimit -f 1; exec "$@"'
        done = subprocess.run(["sh", "-c", script, "sh", tool.TOOL, "simulate", "m.toml", "--out", "r.json", "--set",
                               "simulate.output.points=1000"], cwd=self.folder, capture_output=True, text=True,
                              timeout=tool.WAIT)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, r"r.json: error: cannot write: .*File too large")
        self.assertIn("completed", done.stdout)  # the table is all that is left of the computation
        self.assertEqual((self.folder / "r.json").read_bytes(), EARLIER)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["m.toml", "r.json"])


class NotANumber(tool.ToolTest):
    """What the numerics meet is written as far as it was computed, and says where it stopped."""

    MODELS = {
        "at the start": ('x = "sqrt(-1 - x^2)"', 0.0, 0.0),
        "division by zero at the start": ('x = "1/(x - 1)"', 0.0, 0.0),
        "later": ('x = "-1/(1 - t)^2"', 0.0, 1.0),  # x = 1 - t/(1 - t)
        "beyond every number": ('x = "exp(exp(10*t))"', 0.0, 1.0),
        "in one region only": ('x = "if(x > 0.5, -1, log(-1 - v^2))"', 0.0, 0.5),
        "in finite time": ('x = "x^2"', 0.0, 1.0),  # x = 1/(1 - t)
    }

    def test_stops_with_what_it_has(self):
        for name, (line, earliest, latest) in self.MODELS.items():
            with self.subTest(name):
                self.write("r.json", EARLIER)
                self.write("m.toml", base.with_line(9, line).replace("until = 1", "until = 2"))
                out, err = self.run_tool("simulate", "m.toml", "--out", "r.json", code=3)
                result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
                status = result["status"]
                self.assertIn(status["termination"], ("evaluation_failed", "step_size_too_small"))
                self.assertIn(status["message"], err)
                self.assertGreaterEqual(status["time_reached"], earliest)
                self.assertLessEqual(status["time_reached"], latest + 1e-6)
                self.assertEqual(result["trajectory"]["t"][-1], status["time_reached"])
                self.assertTrue(all(value is not None for row in result["trajectory"]["x"] for value in row))


if __name__ == "__main__":
    tool.main()

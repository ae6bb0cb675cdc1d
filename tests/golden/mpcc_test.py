"""saltus mpcc: optima of the examples, the result file, exit codes, what is refused."""

import json
import math
import unittest

import tool

EXAMPLES = tool.SOURCE / "examples" / "mpcc"
SHARED = tool.SOURCE / ".." / "shared" / "data" / "mpcc"
KEYS = ["format", "file", "sha256", "status", "objective", "x", "names", "presolve", "certificate", "multipliers", "homotopy", "statistics"]


class MpccTest(tool.ToolTest):
    def solve(self, file, *arguments, code=0):
        self.run_tool("mpcc", file, "--out", "r.json", "--quiet", *arguments, code=code)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def refused(self, *arguments, message):
        out, err = self.run_tool("mpcc", *arguments, code=2)
        self.assertEqual(out, "")
        for part in message:
            self.assertIn(part, err)


class Examples(MpccTest):
    OPTIMA = {"corner": 1.0, "slope": 0.0, "ceiling": 5.0, "friction": 40.0 / 11.0, "leader": 1.25, "valve": 0.07618807205}

    def test_optima(self):
        for name, optimum in self.OPTIMA.items():
            result = self.solve(EXAMPLES / f"{name}.nl")
            self.assertEqual(list(result), KEYS)
            self.assertEqual(result["format"], "saltus-mpcc/1")
            self.assertEqual(result["status"], {"termination": "completed", "message": ""}, name)
            self.assertAlmostEqual(result["objective"], optimum, delta=1e-9, msg=name)
            certificate = result["certificate"]
            self.assertIs(certificate["b_stationary"], True)
            for residual in ("primal_infeasibility", "complementarity_residual", "stationarity"):
                self.assertLessEqual(certificate[residual], 1e-8)

    def test_variables_of_the_file_only(self):
        result = self.solve(EXAMPLES / "friction.nl")
        self.assertEqual(len(result["x"]), 3)
        self.assertEqual(len(result["multipliers"]["lower"]), 3)
        self.assertEqual(result["names"], [])

    def test_multipliers_are_those_of_the_documented_lagrangian(self):
        # min (x - 2)^2 + (y - 1)^2 with G = y, H = x at (2, 0): the gradient (0, -2) is that of G times its multiplier.
        multipliers = self.solve(EXAMPLES / "corner.nl")["multipliers"]
        self.assertAlmostEqual(multipliers["G"][0] + multipliers["lower"][1], -2.0, delta=1e-8)
        self.assertAlmostEqual(multipliers["H"][0] + multipliers["lower"][0], 0.0, delta=1e-8)

    def test_names_beside_the_file(self):
        file = self.write("c.nl", (EXAMPLES / "corner.nl").read_text(encoding="utf-8"))
        self.write("c.col", "left\nright\n")
        self.assertEqual(self.solve(file)["names"], ["left", "right"])

    def test_a_stored_result_is_a_start(self):
        first = self.solve(EXAMPLES / "corner.nl")
        stored = self.write("start.json", json.dumps(first | {"x": [0.0, 1.0]}))
        self.assertAlmostEqual(self.solve(EXAMPLES / "corner.nl", "--start", stored)["objective"] % 3.0, 1.0, delta=1e-9)
        self.refused(EXAMPLES / "friction.nl", "--start", stored, message=["the start has 2 values, the problem 3 variables"])
        self.refused(EXAMPLES / "corner.nl", "--start", EXAMPLES / "corner.nl", message=["corner.nl", "not valid JSON"])
        other = self.write("other.json", '{"format": "saltus-result/1", "x": [1, 2]}')
        self.refused(EXAMPLES / "corner.nl", "--start", other, message=['expected "saltus-mpcc/1"'])
        holes = self.write("holes.json", '{"format": "saltus-mpcc/1", "x": [1, null]}')
        self.refused(EXAMPLES / "corner.nl", "--start", holes, message=["/x/1", "finite"])

    def test_table(self):
        out, err = self.run_tool("mpcc", EXAMPLES / "friction.nl", code=0)
        self.assertEqual(err, "")
        self.assertRegex(out, r"(?m)^status +completed$")
        self.assertRegex(out, r"(?m)^objective +3\.63636363\d*$")
        self.assertRegex(out, r"(?m)^certificate +Feasible to ")
        self.assertIn("B-stationary (S)", out)
        self.assertRegex(out, r"(?m)^  relaxed +1e\+00 ")
        self.assertLessEqual(max(map(len, out.splitlines())), 140)

    def test_every_relaxation(self):
        for method in ("scholtes", "fischer_burmeister", "chen_chen_kanzow", "kanzow_schwartz", "lin_fukushima", "kadrani"):
            result = self.solve(EXAMPLES / "valve.nl", "--method", method)
            self.assertAlmostEqual(result["objective"], self.OPTIMA["valve"], delta=1e-7, msg=method)

    def test_limits_end_early_and_write(self):
        result = self.solve(EXAMPLES / "slope.nl", "--set", "mpcc.iteration_limit=3", code=3)
        self.assertEqual(result["status"]["termination"], "iteration_limit")
        self.assertEqual(len(result["x"]), 2)


class Refused(MpccTest):
    def test_command_line(self):
        corner = EXAMPLES / "corner.nl"
        self.refused("none.nl", message=["none.nl", "no such file"])
        self.refused(corner, "--method", "scholte", message=["--method scholte", "did you mean 'scholtes'"])
        self.refused(corner, "--solver", "snopt", message=["--solver snopt", 'expected "structured" or "ipopt"'])
        self.refused(corner, "--time-limit", "-1", message=["--time-limit -1", "seconds > 0"])
        self.refused(corner, "--set", "mpcc.tolerence=1", message=["unknown option mpcc.tolerence", "did you mean 'tolerance'"])
        self.refused(corner, "--set", "mpcc.tolerance=-1", message=["--set mpcc.tolerance=-1", "expected a finite number > 0"])
        self.refused(corner, "--set", "mpcc.sigma_factor=2", message=["expected a number > 0 and < 1"])
        self.refused(corner, "--set", "mpcc.sigma_final=2", message=["sigma_final (2) is above sigma_initial (1)"])
        self.refused(corner, "--set", "simulate.rtol=1", message=["options begin with mpcc."])
        self.refused(corner, "--set", "mpcc.tolerance", message=["expected mpcc.KEY=VALUE"])
        self.refused(corner, "--out", "none/r.json", message=["there is no folder"])

    def test_files(self):
        good = (EXAMPLES / "corner.nl").read_text(encoding="utf-8")
        cases = {
            "empty.nl": ("", ["the file is empty"]),
            "model.toml": ("[model]\n", ["neither an AMPL .nl text"]),
            "binary.nl": ("b3 0 1 0\n", ["this .nl file is binary", "write gNAME;"]),
            "cut.nl": (good[:len(good) // 2], ["cut.nl:", "the file ends", "not complete"]),
            "integer.nl": (good.replace(" 0 0 0 0 0\t# discrete", " 1 0 0 0 0\t# discrete"), ["integer.nl:7", "binary or integer"]),
            "wrong.nl": (good.replace("5 1 1", "5 1 9"), ["expected the variable of a complementarity from 1 to 2, found 9"]),
            "undefined.nl": (good.replace("O0 0\n", "O0 0\no0\no43\nn-1\n"), ["undefined.nl", "the objective is nan at the start"]),
            "list.json": ("[1, 2]", ["neither an AMPL .nl text"]),
            "other.json": ('{"x": 1}', ["NOSBENCH", "MacMPEC"]),
            "cut.json": ('{"f_fun": "abc', ["cut.json:1", "the file ends in the middle"]),
        }
        for name, (text, message) in cases.items():
            self.refused(self.write(name, text), "--out", "r.json", message=message)
            self.assertFalse((self.folder / "r.json").exists())


@unittest.skipUnless(SHARED.exists(), "no foreign files beside the source")
class SharedFiles(MpccTest):
    """What others wrote: no result that says more than its own numbers."""

    OPTIMA = {"bard1": 17.0, "desilva": -1.0, "gauvin": 20.0, "jr1": 0.5, "kth1": 0.0, "ralph1": 0.0, "ralph2": 0.0,
              "scholtes1": 2.0, "scholtes3": 0.5, "scholtes5": 1.0, "stackelberg1": -9800.0 / 3.0, "qpec1": 80.0}

    def test_optima(self):
        for name, optimum in self.OPTIMA.items():
            result = self.solve(SHARED / f"{name}.nl")
            self.assertTrue(math.isclose(result["objective"], optimum, rel_tol=1e-8, abs_tol=1e-8), (name, result["objective"]))


if __name__ == "__main__":
    tool.main()

"""Results that stand alone: what a result file says of its model, and how it is run again."""

import json

import tool

TABLES = """
[model]
name = "tables"
[states]
x = 0
[controls]
u = 0
[dynamics]
x = "road(t) + u - sign(x - 0.21)"
[tables.road]
file = "road.csv"
[simulate]
until = 2
inputs = { u = { file = "u.csv" } }
"""

BLOCK = """
[model]
name = "block"
[states]
q = 0
v = 0
[controls]
u = { lower = -2, upper = 2 }
[dynamics]
q = "v"
v = "u - 0.5*sign(v)"
[optimize]
horizon = { free = true, initial = 2, lower = 0.1, upper = 10 }
control_intervals = 4
minimize_time = true
terminal_constraints = ["q == 1", "v == 0"]
"""


class StoredModels(tool.ToolTest):
    def read(self, name):
        return json.loads((self.folder / name).read_text(encoding="utf-8"))

    def computed(self, name):
        """All that a run computes, and not the clock and the call."""
        result = self.read(name)
        for part in [result, *result.get("branches", [])]:
            del part["date"]
            part.pop("command_line", None)
            for key in [key for key in part["statistics"] if key.endswith("seconds")]:
                del part["statistics"][key]
        return result

    def test_a_result_has_its_model(self):
        self.run_tool("simulate", "stick-slip", "--until", "3", "--set", "belt=0.3", "--out", "r.json", "--quiet", code=0)
        result = self.read("r.json")
        text = (tool.SOURCE / "models/stick-slip.toml").read_text(encoding="utf-8")
        self.assertEqual(result["model"]["text"], text)
        self.assertEqual(result["model"]["set"], ["belt=0.3", "simulate.until=3"])
        self.assertEqual(result["model"]["files"], [])
        self.assertEqual(list(result["model"]["initial_state"]), result["states"])
        self.assertEqual(list(result["model"]["initial_state"].values()), result["trajectory"]["x"][0])
        self.assertEqual(result["command_line"], "saltus simulate stick-slip --until 3 --set belt=0.3")
        equations = [(line["left"], line["where"]) for line in result["model"]["equations"]]
        self.assertEqual(equations[:2], [("q'", ""), ("v'", "")])
        self.assertIn("switching function", [where for _, where in equations])

    def test_it_runs_again_with_the_same_bits(self):
        runs = {"stick-slip": [], "two-belts": ["--method", "fesd"], "bouncing-ball": ["--set", "simulate.output=auto"],
                "spontaneous-switch": ["--branch", "all"], "relay-feedback": ["--integrator", "taylor", "--until", "5"],
                "crossing": ["--method", "smoothed"], "chua": ["--set", "simulate.output.points=11", "--rtol", "1e-5"]}
        for model, arguments in runs.items():
            with self.subTest(model=model):
                self.run_tool("simulate", model, *arguments, "--out", "r.json", "--quiet", code=0)
                self.run_tool("simulate", "r.json", "--out", "again.json", "--quiet", code=0)
                self.assertEqual(self.computed("r.json"), self.computed("again.json"))
                self.assertEqual(self.read("again.json")["command_line"], "saltus simulate r.json")

    def test_what_is_set_anew_replaces_what_was_set(self):
        self.run_tool("simulate", "stick-slip", "--set", "belt=0.3", "--until", "3", "--out", "r.json", "--quiet", code=0)
        for setting in ("belt=0.4", "parameters.belt=0.4"):
            self.run_tool("simulate", "r.json", "--set", setting, "--until", "2", "--out", "s.json", "--quiet", code=0)
            result = self.read("s.json")
            self.assertEqual(result["model"]["parameters"]["belt"], 0.4)
            self.assertEqual(result["final"]["t"], 2.0)
            self.run_tool("simulate", "stick-slip", "--set", "belt=0.4", "--until", "2", "--out", "t.json", "--quiet",
                          code=0)
            self.assertEqual(result["events"], self.read("t.json")["events"])

    def test_named_files_are_in_it(self):
        self.write("road.csv", "0,1\n1,2\n2,0.5\n")
        self.write("u.csv", "t,u\n0,1\n0.5,2\n")
        self.write("v.csv", "t,u\n0,2\n0.5,1\n")
        self.write("tables.toml", TABLES)
        self.run_tool("simulate", "tables.toml", "--set", "simulate.inputs.u.file=v.csv", "--out", "r.json", "--quiet",
                      code=0)
        self.assertEqual([file["name"] for file in self.read("r.json")["model"]["files"]], ["road.csv", "u.csv", "v.csv"])
        for name in ("road.csv", "u.csv", "v.csv", "tables.toml"):
            (self.folder / name).unlink()
        self.run_tool("simulate", "r.json", "--out", "again.json", "--quiet", code=0)
        self.assertEqual(self.computed("r.json"), self.computed("again.json"))

    def test_a_large_file_must_be_there_and_the_same(self):
        rows = "".join(f"{k},{k % 7}\n" for k in range(150000))
        self.write("road.csv", rows)
        self.write("u.csv", "0,1\n0.5,2\n")
        self.write("tables.toml", TABLES)
        self.run_tool("simulate", "tables.toml", "--out", "r.json", "--quiet", code=0)
        self.assertIsNone(self.read("r.json")["model"]["files"][0]["text"])
        self.run_tool("simulate", "r.json", "--quiet", "--until", "2", code=0)
        self.write("road.csv", rows + "150000,1\n")
        err = self.run_tool("simulate", "r.json", code=2)[1]
        self.assertIn("road.csv: error: this file is not the one with which the result was computed", err)
        (self.folder / "road.csv").unlink()
        err = self.run_tool("simulate", "r.json", code=2)[1]
        self.assertIn("there is no such file", err)

    def test_an_optimum_runs_again(self):
        self.write("block.toml", BLOCK)
        self.run_tool("optimize", "block.toml", "--intervals", "5", "--out", "r.json", "--quiet", code=0)
        self.run_tool("optimize", "r.json", "--out", "again.json", "--quiet", code=0)
        first, again = self.computed("r.json"), self.computed("again.json")
        for key in ("objective", "u", "events", "trajectory", "final", "model"):
            self.assertEqual(first[key], again[key], key)
        _, err = self.run_tool("simulate", "r.json", "--quiet", "--until", "2", code=0)
        self.assertIn("note: the controls are those of the model; for those that were found add --set "
                      "simulate.inputs.u.result=r.json", err)
        _, err = self.run_tool("simulate", "r.json", "--quiet", "--until", "2", "--set",
                               "simulate.inputs.u.result=r.json", code=0)
        self.assertEqual(err, "")
        # Its open form, too: the options of both commands are there.
        self.run_tool("check", "r.json", code=0)

    def test_results_that_cannot_be_run(self):
        self.run_tool("simulate", "crossing", "--out", "r.json", "--quiet", code=0)
        result = self.read("r.json")
        del result["record_sha256"]  # nothing is wrong but what is changed here
        for change, message in (
                (lambda model: [model.pop(key) for key in ("text", "file", "files", "set", "initial_state")],
                 "this result does not contain its model"),
                (lambda model: model.update(text=model["text"] + "# edited\n"), "is not the one with which it was computed"),
                (lambda model: model.update(text=3), "at /model/text: expected a text")):
            changed = json.loads(json.dumps(result))
            change(changed["model"])
            self.write("changed.json", json.dumps(changed))
            err = self.run_tool("simulate", "changed.json", code=2)[1]
            self.assertIn(message, err)
        self.run_tool("report", "r.json", code=0)
        result["model"]["text"] = "# edited\n"
        self.write("changed.json", json.dumps(result))
        for command in (("report", "changed.json"), ("diff", "r.json", "changed.json")):
            self.assertIn("at /model/text: the model in this result is not", self.run_tool(*command, code=2)[1])
        self.write("cut.json", json.dumps(result)[:1500])
        self.assertIn("cut.json:1:", self.run_tool("simulate", "cut.json", code=2)[1])

    def test_a_result_without_its_model_still_opens(self):
        self.run_tool("simulate", "crossing", "--out", "r.json", "--quiet", code=0)
        result = self.read("r.json")
        for key in ("text", "file", "files", "set", "initial_state"):
            del result["model"][key]
        del result["command_line"], result["record_sha256"]
        self.write("old.json", json.dumps(result))
        self.run_tool("report", "old.json", code=0)


if __name__ == "__main__":
    tool.main()

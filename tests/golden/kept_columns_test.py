"""Rows with some of the columns only: output = { states = [...], surfaces = [...] }."""

import csv
import json
import zipfile

import tool

MODEL = """
[model]
name = "three"
[parameters]
k = 2.0
[states]
x = 1.0
v = 0.0
w = 0.5
[dynamics]
x = "v"
v = "-x - 0.1*v - k*sign(v + 0.3*x - 0.5*sin(3*t))"
w = "0.3*sign(0.2 - w) - 0.1*v"
[outputs]
energy = "0.5*(x^2 + v^2)"
[simulate]
until = 12
output = { points = 40, states = ["w", "x*"], surfaces = ["*w*"] }
"""
ALL = MODEL.replace(', states = ["w", "x*"], surfaces = ["*w*"]', "")


class KeptColumns(tool.ToolTest):
    def read(self, name):
        return json.loads((self.folder / name).read_text(encoding="utf-8"))

    def pair(self, *words, more=()):
        """The same run with all columns and with some, as JSON."""
        self.write("some.toml", MODEL)
        self.write("all.toml", ALL)
        for name in ("some", "all"):
            self.run_tool("simulate", f"{name}.toml", "--quiet", *words, "--out", f"{name}.json", *more, code=0)
        return self.read("some.json"), self.read("all.json")

    def check(self, some, everything):
        self.assertEqual(some["kept_columns"], {"states": ["x", "w"], "switching_functions": ["0.2-w"]})
        self.assertNotIn("kept_columns", everything)
        self.assertEqual(some["states"], ["x", "v", "w"])
        function = everything["switching_functions"].index("0.2-w")
        for of_some, of_all in zip(some["trajectory"]["x"], everything["trajectory"]["x"], strict=True):
            self.assertEqual(of_some, [of_all[0], of_all[2]])
        for column in ("alpha", "mode"):
            self.assertEqual([row for row, in some["trajectory"][column]],
                             [row[function] for row in everything["trajectory"][column]])
        for same in ("final", "events"):
            self.assertEqual(some[same], everything[same])
        for same in ("t", "u", "outputs"):
            self.assertEqual(some["trajectory"][same], everything["trajectory"][same])

    def test_every_method(self):
        for words in ([], ["--integrator", "radau5"], ["--method", "smoothed"], ["--method", "timestepping"],
                      ["--method", "fesd"]):
            with self.subTest(words=words):
                self.check(*self.pair(*words))

    def test_grown_files_are_those_written_at_the_end(self):
        self.write("m.toml", MODEL)
        names = [word for suffix in ("json", "csv", "events.csv", "npz") for word in ("--out", f"NAME.{suffix}")]
        for name, more in (("grown", []), ("whole", ["--report", "r.html"])):
            self.run_tool("simulate", "m.toml", "--quiet", *(word.replace("NAME", name) for word in names), *more, code=0)
        for suffix in ("csv", "events.csv"):
            self.assertEqual((self.folder / f"grown.{suffix}").read_text(), (self.folder / f"whole.{suffix}").read_text())
        self.assertEqual((self.folder / "grown.npz").read_bytes(), (self.folder / "whole.npz").read_bytes())
        with open(self.folder / "grown.csv", encoding="utf-8", newline="") as file:
            head = next(csv.reader(file))
        self.assertEqual(head, ["t", "side", "x", "w", "energy", "alpha(0.2-w)", "mode(0.2-w)"])
        names = zipfile.ZipFile(self.folder / "grown.npz").namelist()
        self.assertIn("w.npy", names)
        self.assertNotIn("v.npy", names)
        self.assertIn("events.v.npy", names)

    def test_names_on_the_command_line(self):
        self.write("m.toml", ALL)
        for value, kept in (('["v"]', ["v"]), ("[x, w]", ["x", "w"]), ("v", ["v"]), ("[]", [])):
            self.run_tool("simulate", "m.toml", "--quiet", "--out", "r.json", "--set", f"simulate.output.states={value}",
                          code=0)
            result = self.read("r.json")
            self.assertEqual(result["kept_columns"]["states"], kept)
            self.assertEqual(len(result["trajectory"]["x"][0]), len(kept))

    def test_what_there_is_not_is_refused_with_its_place(self):
        for wrong, message in (('["x", "vv"]', "unknown state 'vv'"), ('["q*"]', "no state fits 'q*'")):
            self.write("m.toml", MODEL.replace('["w", "x*"]', wrong))
            _, error = self.run_tool("simulate", "m.toml", "--out", "r.json", code=2)
            self.assertIn(message, error)
            self.assertIn("m.toml:1", error)
            self.assertFalse((self.folder / "r.json").exists())
        self.write("m.toml", MODEL.replace('["*w*"]', '["z"]'))
        self.assertIn("unknown switching function 'z'", self.run_tool("simulate", "m.toml", code=2)[1])
        self.write("m.toml", MODEL.replace('["w", "x*"]', "[1, 2]"))
        self.assertIn("a list of names", self.run_tool("simulate", "m.toml", code=2)[1])

    def test_it_runs_again_and_is_compared(self):
        self.pair()
        self.run_tool("simulate", "some.json", "--quiet", "--out", "again.json", code=0)
        some, again = self.read("some.json"), self.read("again.json")
        for same in ("trajectory", "final", "events", "kept_columns"):
            self.assertEqual(some[same], again[same])
        out, _ = self.run_tool("diff", "some.json", "all.json", code=0)
        self.assertIn("2 of 3 states at", out)
        self.run_tool("simulate", "some.json", "--quiet", "--out", "other.json", "--set", "k=2.1", code=0)
        out, _ = self.run_tool("diff", "some.json", "other.json", code=1)
        self.assertIn("v ", out)  # at the end all states are compared

    def test_pictures_show_what_is_there(self):
        self.pair(more=["--report", "r.html"])
        for files in (["some.json", "all.json"], ["all.json", "some.json"]):
            self.run_tool("report", *files, "--out", "page.html", code=0)
        self.run_tool("report", "some.json", "--figure", "f.svg", code=0)
        drawn = (self.folder / "f.svg").read_text(encoding="utf-8")
        self.assertIn(">w<", drawn)
        self.assertNotIn(">v<", drawn)
        self.run_tool("report", "some.json", "--figure", "p.svg", "--phase", "x,w", code=0)
        self.assertIn("no column 'v'", self.run_tool("report", "some.json", "--figure", "p.svg", "--phase", "x,v", code=2)[1])

    def test_files_that_disagree_with_themselves(self):
        some, _ = self.pair()
        some["kept_columns"]["states"] = ["w", "x"]
        self.write("r.json", json.dumps(some))
        self.assertIn("in its order", self.run_tool("report", "r.json", code=2)[1])
        some["kept_columns"]["states"] = ["x"]
        self.write("r.json", json.dumps(some))
        self.assertIn("expected 1 entries, found 2", self.run_tool("report", "r.json", code=2)[1])

    def test_comparing_methods_needs_all(self):
        self.write("m.toml", MODEL)
        self.run_tool("compare", "m.toml", "--until", "1", "--quiet", "--out", "c.json", code=0)
        self.assertNotIn("kept_columns", self.read("c.json"))


if __name__ == "__main__":
    tool.main()

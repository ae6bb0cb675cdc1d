"""Malformed model files: every one is refused within seconds with exit code 2, its place, and a message that helps, and
an earlier result stays as it was."""

import itertools
import resource

import tool
from malformed import base, expressions, names, tables, texts, values

TOPICS = {"texts": texts.FILES, "names": names.FILES, "values": values.FILES, "expressions": expressions.FILES,
          "tables": tables.FILES}
SECONDS = 5.0  # of the processor; ten megabytes take about one


def processor_seconds():
    """Of all tools run so far; unlike the clock, other work on the machine does not change it."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class MalformedModels(tool.ToolTest):
    def test_the_model_they_are_made_from_is_good(self):
        self.run_tool("simulate", self.write("good.toml", base.GOOD), "--quiet", code=0)

    def test_they_are_many_and_all_different(self):
        contents = [case[0] for files in TOPICS.values() for case in files.values()]
        self.assertGreaterEqual(len(contents), 150)
        self.assertEqual(len({content if isinstance(content, bytes) else content.encode() for content in contents}),
                         len(contents))

    def check(self, content, place, *expected):
        self.write("m.toml", content)
        earlier = b'{"an": "earlier result"}'
        self.write("r.json", earlier)
        begin = processor_seconds()
        out, err = self.run_tool("simulate", "m.toml", "--out", "r.json", code=2)
        self.assertLess(processor_seconds() - begin, SECONDS)
        self.assertEqual(out, "")
        errors = [line for line in err.splitlines() if "error: " in line]
        self.assertEqual(len(errors), 1, err)
        exact = {None: "", str: f":{place}"}.get(place if place is None else type(place), rf":{place}:\d+")
        self.assertRegex(errors[0], rf"^m\.toml{exact}: error: .")
        for part in expected:
            self.assertIn(part, err)
        self.assertLess(max(map(len, err.splitlines())), 4000)
        self.assertNotRegex(err, r"[\x00-\x09\x0b-\x1f\x7f]")
        self.assertEqual((self.folder / "r.json").read_bytes(), earlier)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["m.toml", "r.json"])

    def test_all(self):
        for topic, name in itertools.chain.from_iterable(((t, n) for n in f) for t, f in TOPICS.items()):
            with self.subTest(f"{topic}: {name}"):
                self.check(*TOPICS[topic][name])

    def test_files_of_other_programs_are_named_as_what_they_are(self):
        for name, content, what, anchor in (
                ("m.xml", '<?xml version="1.0"?>\n<sbml level="3"></sbml>\n', "this is SBML", "#sbml-tools-copasi-tellurium"),
                ("m.fmu", b"PK\x03\x04\x14\x00\x00", "this is an FMU", "#modelica"),
                ("A.mo", "model A\n  Real x;\nend A;\n", "this is Modelica", "#modelica"),
                ("m.slx", b"PK\x03\x04\x14\x00\x00", "this is a model of Simulink", "#matlab-simulink-stateflow"),
                ("pendulum.m", "dx = @(t, x) -x;\n", "this is a program of MATLAB", "#matlab-simulink-stateflow"),
                ("arm.xml", "<mujoco></mujoco>\n", "this is a robot's XML", "#drake-mujoco")):
            with self.subTest(name):
                self.write(name, content)
                for command in (("simulate", name, "--out", "r.json"), ("check", name)):
                    _, err = self.run_tool(*command, code=2)
                    self.assertIn(f"{name}: error: {what}", err)
                    self.assertIn(f"coming-from.md{anchor}", err)
                self.assertFalse((self.folder / "r.json").exists())
        page = (tool.SOURCE / "docs/coming-from.md").read_text(encoding="utf-8")
        for heading in ("## SBML tools: COPASI, Tellurium", "## Modelica", "## MATLAB, Simulink, Stateflow", "## Drake, MuJoCo"):
            self.assertIn(heading, page)


if __name__ == "__main__":
    tool.main()

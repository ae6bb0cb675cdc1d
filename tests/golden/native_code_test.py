"""Model functions as compiled code: the same digits, whatever the method, and what happens without a compiler."""

import json
import shutil

import tool

# Model, options: both forms, sliding, regions, time-stepping, sensitivities, steps as problems with complementarities.
RUNS = (
    ("stick-slip", ["method=event"]),
    ("stick-slip", ["method=fesd", "fesd.stages=3", "fesd.sensitivities=true"]),
    ("stick-slip", ["method=fesd", "fesd.reformulation=stewart", "fesd.scheme=gauss_legendre"]),
    ("relay-feedback", ["method=fesd", "fesd.steps=300", "until=4"]),
    ("relay-feedback", ["method=fesd", "fesd.reformulation=stewart", "fesd.steps=300", "until=4"]),
    ("irma", ["method=fesd", "until=100", "fesd.steps=60"]),
    ("rotating-oscillator", ["method=timestepping", "timestepping.steps=400"]),
    ("stick-slip", ["method=timestepping", "timestepping.reformulation=stewart", "timestepping.steps=400"]),
    ("crossing", ["method=fesd", "fesd.step_equilibration=heuristic_mean", "fesd.steps=4"]),
)


class NativeCode(tool.ToolTest):
    def simulate(self, model, settings, native, code=0, **environment):
        """The result, or what stands in standard error."""
        words = [word for setting in [*settings, f"native={native}"] for word in ("--set", f"simulate.{setting}")]
        environment = {"SALTUS_CACHE": str(self.folder / "cache")} | environment
        _, errors = self.run_tool("simulate", model, "--out", "r.json", "--quiet", *words, code=code,
                                  environment=environment)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8")) if code == 0 else errors

    def compiled(self):
        return {file.name: file.stat().st_mtime_ns for file in (self.folder / "cache").glob("*.so")}

    def test_digits_do_not_depend_on_it(self):
        for model, settings in RUNS:
            with self.subTest(model=model, settings=settings):
                shutil.rmtree(self.folder / "cache", ignore_errors=True)
                interpreted = self.simulate(model, settings, "off")
                self.assertEqual(self.compiled(), {})
                native = self.simulate(model, settings, "on")
                self.assertNotEqual(self.compiled(), {})
                self.assertEqual(interpreted["status"]["termination"], "completed")
                self.assertGreater(interpreted["statistics"]["rhs_evaluations"], 0)
                for result in (interpreted, native):
                    del result["statistics"]["wall_seconds"], result["options"]["simulate.native"]
                    del result["command_line"], result["date"], result["record_sha256"], result["model"]["set"]  # they say what was asked for
                self.assertEqual(native, interpreted)

    def test_is_compiled_once(self):
        settings = ["method=fesd", "fesd.steps=20"]
        self.simulate("stick-slip", settings, "on")
        stored = self.compiled()
        self.simulate("stick-slip", settings, "on")
        self.assertEqual(self.compiled(), stored)

    def test_without_a_compiler_it_is_refused_where_it_is_insisted_on(self):
        for method in ("event", "fesd", "timestepping"):
            with self.subTest(method=method):
                settings = [f"method={method}", "timestepping.steps=400"]
                self.simulate("stick-slip", settings, "auto", CC="/no/such/compiler")
                errors = self.simulate("stick-slip", settings, "on", code=2, CC="/no/such/compiler")
                self.assertIn("the C compiler '/no/such/compiler' did not compile the model functions", errors)
                self.assertIn('native = "off"', errors)


if __name__ == "__main__":
    tool.main()

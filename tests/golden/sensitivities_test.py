"""simulate.fesd.sensitivities: in result and table; the numbers themselves have their tests in tests/unit."""

import json

import tool


class Sensitivities(tool.ToolTest):
    def run_model(self, model, *settings, method="fesd", steps=40, scheme="radau_iia", stages=3, form="step"):
        words = [f"{method}.steps={steps}", f"{method}.scheme={scheme}", f"{method}.stages={stages}",
                 f"{method}.reformulation={form}", f"{method}.sensitivities=true", "output.points=2"]
        sets = [part for word in words for part in ("--set", f"simulate.{word}")]
        self.run_tool("simulate", model, "--method", method, "--quiet", "--out", "s.json", *sets,
                      *(part for setting in settings for part in ("--set", setting)), code=0)
        return json.loads((self.folder / "s.json").read_text(encoding="utf-8"))

    def assert_near(self, found, expected, tolerance):
        for row, exact in zip(found, expected, strict=True):
            for value, reference in zip(row, exact, strict=True):
                self.assertLessEqual(abs(value - reference), tolerance * max(1.0, abs(reference)))

    def test_a_crossing_has_the_ratio_of_its_speeds(self):
        for form in ("step", "stewart"):
            for scheme, stages in (("radau_iia", 1), ("radau_iia", 3), ("gauss_legendre", 2), ("explicit", 4)):
                result = self.run_model("crossing", scheme=scheme, stages=stages, form=form, steps=7)
                self.assert_near(result["sensitivities"]["x0"], [[1 / 3]], 1e-12)

    def test_timestepping_gives_the_wrong_value_for_every_step(self):
        for steps in (7, 70, 700):
            result = self.run_model("crossing", method="timestepping", steps=steps, stages=1)
            self.assertGreater(abs(result["sensitivities"]["x0"][0][0] - 1 / 3), 0.3)

    def test_the_rotating_oscillator_has_its_matrix(self):
        # d x(T) / d x0 of problem 3, in closed form.
        exact = [[21.66946501324, -2.06995427137], [56.63750249010, -4.34234751571]]
        result = self.run_model("rotating-oscillator", stages=5)
        self.assert_near(result["sensitivities"]["x0"], exact, 1e-9)
        self.assertEqual(result["sensitivities"]["parameters"], list(result["model"]["parameters"]))

    def test_they_stand_in_the_table_and_only_if_asked_for(self):
        table, _ = self.run_tool("simulate", "crossing", "--method", "fesd", "--set", "simulate.fesd.sensitivities=true",
                                 code=0)
        self.assertIn("sensitivities of the end state", table)
        self.assertIn("0.333333333", table)
        self.run_tool("simulate", "crossing", "--method", "fesd", "--quiet", "--out", "r.json", code=0)
        self.assertNotIn("sensitivities", json.loads((self.folder / "r.json").read_text(encoding="utf-8")))
        stored = self.run_model("crossing")
        self.run_tool("report", "s.json", code=0)
        stored["sensitivities"]["x0"] = [[1, 2]]
        self.write("broken.json", json.dumps(stored))
        self.assertIn("/sensitivities/x0", self.run_tool("report", "broken.json", code=2)[1])
        _, errors = self.run_tool("simulate", "crossing", "--set", "simulate.fesd.sensitivities=maybe", code=2)
        self.assertIn("expected true or false", errors)


if __name__ == "__main__":
    tool.main()

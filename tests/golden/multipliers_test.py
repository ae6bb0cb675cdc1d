"""The multipliers of the paper's Example 3 (its Fig. 2), lengths of elements (Fig. 3) and sizes (Fig. 4) in results."""

import itertools
import json

import tool

NOISE = 1e-9


class Multipliers(tool.ToolTest):
    def run_model(self, model, *settings, method="fesd", steps=10):
        sets = [part for word in (f"{method}.steps={steps}", *settings) for part in ("--set", f"simulate.{word}")]
        self.run_tool("simulate", model, "--method", method, "--quiet", "--out", "r.json", *sets, code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def elements(self, result):
        """Elements as lists of points (t, lambda row, selection row)."""
        record = result["elements"]
        rows = list(zip(record["t"], record["lambda"], record["selection"], strict=True))
        n = record["points"]
        self.assertEqual(n, result["options"][f"simulate.{result['method']}.stages"] + 2)
        return [rows[i:i + n] for i in range(0, len(rows), n)]

    def check_complementarities(self, elements, form):
        for element in elements:
            for _, (multiplier, *others), (selection, *weights) in element:
                if form == "step":
                    # 0 <= lambda_n _|_ alpha >= 0, 0 <= lambda_p _|_ 1 - alpha >= 0
                    self.assertLess(max(-multiplier, 0.0) * selection, NOISE)
                    self.assertLess(max(multiplier, 0.0) * (1.0 - selection), NOISE)
                else:
                    self.assertAlmostEqual(selection + sum(weights), 1.0, delta=NOISE)
                    for lam, theta in zip((multiplier, *others), (selection, *weights), strict=True):
                        self.assertGreaterEqual(lam, 0.0)
                        self.assertLess(lam * theta, NOISE)

    def test_lambda_is_continuous_and_alpha_jumps_in_the_four_cases(self):
        # alpha before and behind the switch, and its time; the last solution is not unique, alpha 1 or 0
        cases = {"crossing": (0, 1, 1 / 3), "sliding": (0, 0.4, 0.964369628659), "leaving-sliding": (1, 1, 1.0),
                 "spontaneous-switch": (None, None, 0.0)}
        for model, (before, behind, at) in cases.items():
            for form in ("step", "stewart"):
                result = self.run_model(model, f"fesd.reformulation={form}", "fesd.stages=4")
                elements = self.elements(result)
                self.check_complementarities(elements, form)
                self.assertAlmostEqual(elements[0][0][0], 0.0)
                self.assertEqual(elements[-1][-1][0], result["final"]["t"])
                largest = max(abs(a[1][0] - b[1][0]) for left, right in zip(elements, elements[1:])
                              for a, b in ((left[-1], right[0]),))
                self.assertLess(largest, NOISE, f"{model}: lambda jumps")
                switch = [i for i, element in enumerate(elements) if abs(element[0][0] - at) < 1e-4]
                self.assertEqual(len(switch), 1, model)
                event = result["events"][-1]
                self.assertEqual(event["unique"], model != "spontaneous-switch")
                self.assertAlmostEqual(elements[switch[0]][0][2][0], event["alpha_after"][0], delta=1e-12)
                if behind is not None:
                    self.assertAlmostEqual(elements[switch[0]][0][2][0], behind, delta=0.01)
                if before is not None:
                    self.assertAlmostEqual(elements[switch[0] - 1][-1][2][0], before, delta=1e-6)

    def test_the_selection_of_sliding_is_that_of_the_closed_form(self):
        from math import sin
        result = self.run_model("sliding", "fesd.stages=4", steps=40)
        entered = result["events"][0]["t"]
        sliding = [point for element in self.elements(result) if element[0][0] >= entered for point in element]
        self.assertGreater(len(sliding), 100)
        for t, _, (alpha,) in sliding:
            self.assertAlmostEqual(alpha, 0.5 * (1 + 0.2 * sin(5 * t)), delta=1e-5)

    def lengths(self, result):
        return [element[-1][0] - element[0][0] for element in self.elements(result)]

    def test_lengths_are_free_without_equilibration_and_equal_with_it(self):
        # Fig. 3: both find the switch; without equilibration the other lengths are whatever the solver ends at.
        settings = ("fesd.elements=6", "fesd.stages=2")
        free = self.run_model("crossing", "fesd.step_equilibration=none", *settings, steps=1)
        equal = self.run_model("crossing", *settings, steps=1)
        fixed = self.run_model("crossing", "timestepping.elements=5", "timestepping.stages=2", method="timestepping",
                               steps=1)
        for result in (free, equal):
            self.assertAlmostEqual(result["events"][0]["t"], 1 / 3, delta=1e-6)
            self.assertAlmostEqual(result["final"]["x"][0], 2 / 3, delta=1e-6)
            self.assertAlmostEqual(sum(self.lengths(result)), 1.0, delta=1e-9)
        at = 1 / 3
        for side in (lambda t: t < at - 1e-6, lambda t: t >= at - 1e-6):
            lengths = [element[-1][0] - element[0][0] for element in self.elements(equal) if side(element[0][0])]
            self.assertGreater(len(lengths), 1)
            self.assertLess(max(lengths) - min(lengths), 1e-12)
        spread = [element[-1][0] - element[0][0] for element in self.elements(free) if element[0][0] > at - 1e-6]
        self.assertGreater(max(spread) - min(spread), 1e-6)
        self.assertLess(max(self.lengths(fixed)) - min(self.lengths(fixed)), 1e-12)
        self.assertGreater(abs(fixed["final"]["x"][0] - 2 / 3), 1e-3)

    def sizes(self, text):
        self.write("m.toml", text)
        out, _ = self.run_tool("check", "m.toml", "--well-posedness", code=0)
        rows = [line for line in out.splitlines() if line.startswith(("  step", "  stewart"))]
        # n_theta, n_beta, n_alg, n_comp, n_eq
        return {row[:30].strip(): [int(n) for n in row[30:].split()[1:]] for row in rows if row[30:].split()}

    def test_sizes_of_both_forms(self):
        # Fig. 4 and Table 4: all 2^n regions with products of two factors at most, and two regions without lifting.
        for n in (3, 4, 5):
            states = [f"x{i}" for i in range(n)]
            head = '[model]\nname = "sizes"\n[states]\n' + "".join(f"{x} = 0.3\n" for x in states)
            modes = ""
            for k, signs in enumerate(itertools.product("<>", repeat=n)):
                when = " and ".join(f"{x} {sign} 0" for x, sign in zip(states, signs, strict=True))
                rates = ", ".join(f'{x} = "{k * n + i}"' for i, x in enumerate(states))
                modes += f'[[modes]]\nwhen = "{when}"\ndynamics = {{ {rates} }}\n'
            found = self.sizes(head + modes + "[simulate]\nuntil = 0.01\n")
            regions, lifted = 2**n, 2**n - 4
            self.assertEqual(found["stewart"], [regions, 0, 2 * regions + 1, regions, regions + 1])
            self.assertEqual(found["step"], [regions, 0, regions + 3 * n, 2 * n, regions + n])
            self.assertEqual(found["step, lifted"],
                             [regions, lifted, regions + 3 * n + lifted, 2 * n, regions + n + lifted])
            both = " and ".join(f"{x} > 0" for x in states)
            two = f'[[modes]]\nwhen = "{both}"\ndynamics = {{ x0 = "1" }}\n[[modes]]\nwhen = "otherwise"\ndynamics = {{ x0 = "2" }}\n'
            rest = "[dynamics]\n" + "".join(f'{x} = "0.1"\n' for x in states[1:])
            found = self.sizes(head + rest + two + "[simulate]\nuntil = 0.01\n")
            self.assertEqual(found["step"], [2, 0, 2 + 3 * n, 2 * n, 2 + n])
            self.assertEqual(found["stewart"][0], regions)

    def test_large_runs_have_none(self):
        result = self.run_model("crossing", steps=30000)
        self.assertNotIn("elements", result)
        self.assertEqual(result["status"]["termination"], "completed")

    def test_a_broken_record_is_refused(self):
        result = self.run_model("crossing")
        self.run_tool("report", "r.json", code=0)
        for key, value, place in (("points", 3, "/elements/points"), ("lambda", [[1.0]], "/elements/lambda"),
                                  ("selections", [{"name": "x", "form": "sum"}], "/elements/selections/0/form")):
            broken = json.loads(json.dumps(result))
            broken["elements"][key] = value
            self.write("broken.json", json.dumps(broken))
            self.assertIn(place, self.run_tool("report", "broken.json", code=2)[1])


if __name__ == "__main__":
    tool.main()

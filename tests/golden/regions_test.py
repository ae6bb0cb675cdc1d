"""Groups of modes by `indicator`: what a person types about them, and finds in the files."""

import csv
import json

import tool

GROUPS = """[model]
name = "two groups"
[states]
x = 0
y = 0.5
[[modes]]
group = "first"
name = "low"
indicator = "x"
dynamics = { x = "-1" }
[[modes]]
group = "first"
name = "high"
indicator = "-x"
dynamics = { x = "1" }
[[modes]]
group = "second"
name = "low"
indicator = "y"
dynamics = { y = "1" }
[[modes]]
group = "second"
indicator = "-y"
dynamics = { y = "-1" }
[simulate]
until = 1
"""


class Files(tool.ToolTest):
    def setUp(self):
        super().setUp()
        self.write("groups.toml", GROUPS)

    def simulate(self, *arguments):
        self.run_tool("simulate", "groups.toml", "--out", "r.json", "--out", "r.csv", "--quiet", *arguments, code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def test_regions_and_weights(self):
        result = self.simulate()
        self.assertEqual(result["region_groups"], [{"name": "first", "modes": ["low", "high"]},
                                                   {"name": "second", "modes": ["low", "mode2"]}])
        self.assertEqual(result["final"]["regions"][1], ["low", "mode2"])
        self.assertEqual(result["final"]["theta"][2:], [0.5, 0.5])
        start, enter = result["events"]
        self.assertEqual((start["kind"], start["surfaces"], start["unique"]), ("start", ["low", "high"], False))
        self.assertNotIn("regions_before", start)
        self.assertEqual(sorted(other["regions"][0] for other in start["alternatives"] + [{"regions": start["regions_after"]}]),
                         [["high"], ["low"], ["low", "high"]])
        self.assertEqual((enter["kind"], enter["surfaces"], enter["t"]), ("enter_sliding", ["low"], 0.5))
        self.assertEqual(len(result["trajectory"]["theta"]), len(result["trajectory"]["t"]))
        self.assertEqual(len(result["trajectory"]["regions"]), len(result["trajectory"]["t"]))

    def test_csv(self):
        result = self.simulate()
        with open(self.folder / "r.csv", newline="", encoding="utf-8") as file:
            head, *rows = csv.reader(file)
        self.assertEqual(head, ["t", "side", "x", "y", "regions(first)", "regions(second)", "theta(first.low)", "theta(first.high)",
                                "theta(second.low)", "theta(second.mode2)"])
        self.assertEqual(rows[-1][5], "low+mode2")
        self.assertEqual([float(field) for field in rows[-1][6:]], result["final"]["theta"])

    def test_the_first_regions_may_be_given(self):
        for name, value, x, regions in (("first.low", 1, -1, ["low"]), ("high", 1, 1, ["high"]),
                                        ("high", 0, 0, ["low", "high"]), ("first.low", -1, 1, ["high"])):
            final = self.simulate("--set", f"simulate.initial_mode.{name}={value}")["final"]
            self.assertEqual((round(final["x"][0], 12), final["regions"][0]), (x, regions), (name, value))

    def test_first_regions_that_are_not_there(self):
        for name, message in (("higg", "high"), ("low", "unknown switching function 'low'")):
            _, error = self.run_tool("simulate", "groups.toml", "--set", f"simulate.initial_mode.{name}=1", code=2)
            self.assertIn(message, error)
        out, _ = self.run_tool("simulate", "groups.toml", "--set", "simulate.initial_mode.mode2=1",
                               "--set", "simulate.initial_mode.first.low=1", code=0)
        self.assertIn("initial_mode", self.run_tool("simulate", "groups.toml", "--set", "simulate.initial_mode.mode2=0",
                                                    code=3)[0])

    def test_branches_follow_other_regions(self):
        result = self.simulate("--branch", "all")
        ends = sorted(branch["final"]["x"][0] for branch in [result, *result["branches"]])
        self.assertEqual([round(end, 12) for end in ends], [-1, 0, 1])
        out, _ = self.run_tool("report", "r.json", code=0)

    def test_the_table_names_them(self):
        out, _ = self.run_tool("simulate", "groups.toml", code=0)
        self.assertRegex(out, r"regions +first\.(low|high) +second\.low \(theta 0\.5\) +second\.mode2 \(theta 0\.5\)")
        self.assertRegex(out, r"0\.5 +enter_sliding +low .*mode2 > low\+mode2")

    def test_check(self):
        out, _ = self.run_tool("check", "groups.toml", code=0)
        self.assertIn("first: 2 regions\n    by the smallest indicator: low, high", out)
        self.assertNotIn('method "smoothed" does not cover', out)

    def test_smoothed_has_weights(self):
        result = self.simulate("--method", "smoothed")
        self.assertEqual([group["name"] for group in result["region_groups"]], ["first", "second"])
        self.assertEqual(result["final"]["regions"][1], ["low", "mode2"])
        for weight in result["final"]["theta"][2:]:
            self.assertAlmostEqual(weight, 0.5, places=6)
        for row in result["trajectory"]["theta"]:
            self.assertAlmostEqual(sum(row[:2]), 1)
            self.assertAlmostEqual(sum(row[2:]), 1)
        enter = [event for event in result["events"] if event["kind"] == "enter_sliding"]
        self.assertEqual(enter[0]["regions_before"][1], ["mode2"])
        self.assertEqual(enter[0]["regions_after"][1], ["low", "mode2"])

    def test_smoothed_refuses_indicators_that_jump(self):
        self.write("jumping.toml", GROUPS.replace('indicator = "x"', 'indicator = "x + step(y - 0.25)"'))
        out, _ = self.run_tool("check", "jumping.toml", code=0)
        self.assertIn('method "smoothed" does not cover indicators that jump', out)
        _, error = self.run_tool("simulate", "jumping.toml", "--method", "smoothed", code=2)
        self.assertIn("use --method event", error)

    def test_damaged_results_are_refused(self):
        result = self.simulate()
        def damaged(change, path):
            copy = json.loads(json.dumps(result))
            change(copy)
            self.write("damaged.json", json.dumps(copy))
            _, error = self.run_tool("report", "damaged.json", code=2)
            self.assertIn(path, error)
        damaged(lambda r: r["final"]["regions"].pop(), "/final/regions")
        damaged(lambda r: r["final"]["theta"].pop(), "/final/theta")
        damaged(lambda r: r["trajectory"]["theta"][3].pop(), "/trajectory/theta/3")
        damaged(lambda r: r["trajectory"]["regions"][2].append(["low"]), "/trajectory/regions/2")
        damaged(lambda r: r["events"][1]["regions_before"].pop(), "/events/1/regions_before")
        damaged(lambda r: r["events"][1]["regions_after"][0].append("nowhere"), "'nowhere' is no mode")
        damaged(lambda r: r.pop("region_groups"), "/trajectory/regions")


if __name__ == "__main__":
    tool.main()

"""saltus order: slopes with and without switch detection, its record, its page and its refusals."""

import json

import tool


class Order(tool.ToolTest):
    def order(self, model, *arguments, code=0):
        self.run_tool("order", model, "--out", "o.json", "--quiet", *arguments, code=code)
        return json.loads((self.folder / "o.json").read_text(encoding="utf-8"))

    def slopes(self, result):
        return {(one["method"], one["scheme"], one["stages"]): (one["slope"], one["switch_time_slope"])
                for one in result["order"]["series"]}

    def test_schemes_keep_their_order_with_detection_and_lose_it_without(self):
        for form in ("step", "stewart"):
            result = self.order("stick-slip", "--schemes", "radau_iia:2,gauss_legendre:2", "--steps", "100,200,400",
                                "--reformulation", form)
            slopes = self.slopes(result)
            for scheme, nominal in (("radau_iia", 3.0), ("gauss_legendre", 4.0)):
                state, time = slopes["fesd", scheme, 2]
                self.assertAlmostEqual(state, nominal, delta=0.35)
                self.assertAlmostEqual(time, nominal, delta=0.35)
            # Without detection errors jump about a line of slope 1: they are compared, not fitted.
            finest = {(one["method"], one["scheme"]): one["points"][-1]["error"] for one in result["order"]["series"]}
            for scheme in ("radau_iia", "gauss_legendre"):
                self.assertGreater(finest["timestepping", scheme], 20 * finest["fesd", scheme])
            self.assertTrue(all(one["reformulation"] == form for one in result["order"]["series"]))

    def test_the_record(self):
        result = self.order("crossing", "--schemes", "radau_iia:1", "--steps", "5,10", "--set",
                            "simulate.fesd.elements=4")
        self.assertEqual(result["command"], "order")
        fesd, timestepping = result["order"]["series"]
        self.assertEqual([point["mean_step"] for point in fesd["points"]], [1 / 20, 1 / 40])
        self.assertEqual([point["mean_step"] for point in timestepping["points"]], [1 / 10, 1 / 20])
        # Straight lines are exact: nothing is above the floor, and nothing has a slope.
        self.assertIsNone(fesd["slope"])
        self.assertLessEqual(fesd["points"][0]["error"], result["order"]["floor"])
        self.assertGreater(timestepping["points"][0]["error"], 1e-4)
        self.assertEqual(result["final"]["t"], 1.0)

    def test_the_table_and_the_page(self):
        table, _ = self.run_tool("order", "crossing", "--schemes", "radau_iia:1", "--steps", "5,10", "--out", "o.json",
                                 "--report", "o.html", code=0)
        self.assertIn("radau_iia 1  timestepping", table)
        self.run_tool("report", "o.json", "--out", "again.html", code=0)
        page = (self.folder / "o.html").read_bytes()
        self.assertEqual(page, (self.folder / "again.html").read_bytes())
        self.assertIn(b'"order":{"floor"', page)

    def test_a_solution_that_is_not_unique_is_said(self):
        arguments = ("order", "stay-or-leave", "--schemes", "radau_iia:2", "--steps", "20,40")
        table, _ = self.run_tool(*arguments, code=0)
        self.assertIn("the solution has other continuations at t = ", table)
        table, _ = self.run_tool(*arguments, "--until", "2", code=0)
        self.assertNotIn("continuations", table)

    def test_refusals(self):
        for arguments, message in ((("--schemes", "radau_ia:2"), "radau_iia"),
                                   (("--schemes", "radau_iia"), "expected NAME:STAGES"),
                                   (("--steps", "20,10"), "ascending"),
                                   (("--reformulation", "heaviside"), "step"),
                                   (("--out", "o.csv"), "must end in .json")):
            out, err = self.run_tool("order", "crossing", *arguments, code=2)
            self.assertIn(message, err)
            self.assertEqual(out, "")
        # Nothing can run: the reason is an error, not an empty table.
        self.assertIn("jumps", self.run_tool("order", "bouncing-ball", "--until", "1", code=2)[1])


if __name__ == "__main__":
    tool.main()

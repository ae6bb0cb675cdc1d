"""What saltus check says of tables, floor and sampled inputs."""

import tool

MODEL = """[model]
name = "piecewise"
[states]
x = 0
[controls]
u = 0
[dynamics]
x = "road(x) + floor(4*t) + mod(t, 0.3) + u"
[tables.road]
x = [0, 1, 2, 3]
y = [0, 0.5, 0, 0.25]
kind = "linear"
[simulate]
until = 1
inputs = { u = { file = "u.csv" } }
"""


class PiecewiseFunctions(tool.ToolTest):
    def test_check_lists_them_with_their_breaks(self):
        self.write("u.csv", "0,1\n0.5,2\n0.7,3\n")
        path = self.write("piecewise.toml", MODEL)
        text, _ = self.run_tool("check", path, code=0)
        self.assertIn("piecewise functions (4)\n", text)
        self.assertIn("  road(x): kinks at 4 breaks\n", text)
        self.assertIn("  floor(4*t): jumps at whole numbers of its argument\n", text)
        self.assertRegex(text, r"  mod\(t,0\.3\).*: jumps at whole numbers of its argument\n")
        self.assertIn("  u: jumps at 2 breaks\n", text)
        text, _ = self.run_tool("check", "stick-slip", code=0)
        self.assertNotIn("piecewise", text)


if __name__ == "__main__":
    tool.main()

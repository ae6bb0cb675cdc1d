"""Shows of every ratchet what it counts, and that a ceiling holds from both sides."""

import tomllib
import unittest

import compile_seconds
import lower_ceilings
import ratchets
from small_tree import TABLE, Tree


class RatchetsSelfTest(unittest.TestCase):
    def items(self, name, changes):
        with Tree(changes) as root:
            return ratchets.items_of(name, root, TABLE)

    def complaints(self, name, changes, ceilings):
        with Tree(changes) as root:
            return ratchets.RATCHET_CHECKS[name](root, {**TABLE, "ceilings": {name: ceilings}})

    def assert_complains(self, name, changes, ceilings, *expected):
        found = self.complaints(name, changes, ceilings)
        self.assertEqual(len(found), 1, found)
        for text in expected:
            self.assertIn(text, found[0])

    def test_ceilings_hold_from_both_sides(self):
        numbers = {"src/saltus/ode/a.cpp": "double f(double x) { return 3.5 * x + 4.5; }\n"}
        self.assertEqual(self.complaints("numeric_literals", numbers, {"ode": 2}), [])
        self.assert_complains("numeric_literals", numbers, {"ode": 1}, "ode: 2 (ceiling 1)", "a.cpp:1: 3.5", "--list numeric_literals")
        self.assert_complains("numeric_literals", numbers, {}, "ode: 2 (ceiling 0)")
        self.assert_complains("numeric_literals", numbers, {"ode": 3}, "ceilings.toml", "lower the ceiling to 2")
        self.assert_complains("numeric_literals", {}, {"ode": 3}, "lower the ceiling to 0")

    def test_lists_name_each(self):
        reaching = {"src/saltus/cli/a.cpp": '#include "saltus/model/system.hpp"\n'}
        listed = ["src/saltus/cli/a.cpp"]
        self.assertEqual(self.complaints("reaches_casadi", reaching, {"cli": listed}), [])
        self.assert_complains("reaches_casadi", reaching, {}, "src/saltus/cli/a.cpp: not in the list of cli")
        self.assert_complains("reaches_casadi", reaching, {"cli": [*listed, "src/saltus/cli/b.cpp"]}, "take src/saltus/cli/b.cpp off")

    def test_ceilings_are_lowered_and_not_raised(self):
        changes = {
            "src/saltus/ode/a.cpp": "double f(double x) { return 3.5 * x + 4.5; }\n",
            "src/saltus/cli/a.cpp": '#include "saltus/model/system.hpp"\n',
        }
        old = {
            "numeric_literals": {"ode": 5, "model": 1},
            "reaches_casadi": {"cli": ["src/saltus/cli/a.cpp", "src/saltus/cli/b.cpp"]},
        }
        with Tree(changes) as root:
            new = lower_ceilings.lowered_ceilings(root, {**TABLE, "ceilings": old}, may_rise=False)
            low = lower_ceilings.lowered_ceilings(root, {**TABLE, "ceilings": {"numeric_literals": {"ode": 1}}}, may_rise=False)
            risen = lower_ceilings.lowered_ceilings(root, {**TABLE, "ceilings": {}}, may_rise=True)
        self.assertEqual(new["numeric_literals"], {"ode": 2})
        self.assertEqual(new["reaches_casadi"], {"cli": ["src/saltus/cli/a.cpp"]})
        self.assertEqual((low["numeric_literals"], low["reaches_casadi"]), ({"ode": 1}, {}))
        self.assertEqual(risen, new)
        self.assertEqual(tomllib.loads(lower_ceilings.text_of(new)), new)

    def test_casadi_through_other_headers(self):
        changes = {
            "src/saltus/evaluation/kernel.hpp": '#include "saltus/model/system.hpp"\n',
            "src/saltus/event_integrator/run.hpp": '#include "saltus/evaluation/kernel.hpp"\n',
            "src/saltus/event_integrator/run.cpp": '#include "saltus/event_integrator/run.hpp"\n',
            "src/saltus/event_integrator/mode.cpp": "#include <vector>\n// #include <casadi/casadi.hpp>\n",
        }
        self.assertEqual(self.items("reaches_casadi", changes), {"event_integrator": ["src/saltus/event_integrator/run.cpp"]})

    def test_eigen_outside_of_its_home(self):
        changes = {
            "src/saltus/linalg/lu.hpp": "#include <Eigen/LU>\n",
            "src/saltus/linalg/lu.cpp": '#include "saltus/linalg/lu.hpp"\n',
            "src/saltus/adapters/qp/a.cpp": "#include <Eigen/Core>\n",
            "src/saltus/switching/a.cpp": '#include "saltus/linalg/lu.hpp"\n',
            "src/saltus/switching/b.cpp": "#include <unsupported/Eigen/Polynomials>\n",
        }
        expected = {"switching": ["src/saltus/switching/a.cpp", "src/saltus/switching/b.cpp"]}
        self.assertEqual(self.items("reaches_eigen", changes), expected)

    def test_includes_that_no_source_names(self):
        forced = "target_compile_options(a PRIVATE -include ${HERE}/all.hpp)\n# -include nothing\n"
        self.assertEqual(self.items("forced_includes", {"cmake/module.cmake": forced}), {"build": ["cmake/module.cmake:1: ${HERE}/all.hpp"]})
        self.assertEqual(self.items("forced_includes", {"cmake/module.cmake": "include(a)\nset(header-include b)\n"}), {})

    def test_headers_of_rooms_of_others(self):
        names = ("solver/face.hpp", "solver/homotopy/path.hpp", "adapters/ipopt/face.hpp", "pipeline/mpcc/own.hpp")
        changes = {"src/saltus/pipeline/a.cpp": "".join(f'#include "saltus/{name}"\n' for name in names)}
        self.assertEqual(self.items("rooms_of_others", changes), {"pipeline": ["saltus/solver/homotopy/path.hpp"]})

    def test_circles_of_calls(self):
        header = "class Run {\n public:\n  void one();\n  int few() const { return many(); }\n\n private:\n  int many() const;\n};\n"
        source = (
            "void Run::one() {\n  if (x) return two(3.0);\n}\n"
            "void Run::two(double a,\n              double b) {\n  other.one();\n  three();\n}\n"
            "void Run::three() {\n  // two()\n  std::one();\n  int two(4);\n  Run::one();\n}\n"
            "int Run::many() const {\n  this->few();\n  return 1;\n}\n"
            "void Run::four() {\n  four();\n  one();\n}\n"
        )
        changes = {"src/saltus/ode/run.hpp": header, "src/saltus/ode/run.cpp": source}
        expected = ["few (calls many)", "many (calls few)", "one (calls two)", "three (calls one)", "two (calls three)"]
        self.assertEqual(self.items("call_cycles", changes), {"ode::Run": expected})
        self.assert_complains("call_cycles", changes, {"ode::Run": 4}, "ode::Run: 5 (ceiling 4)", "few (calls many)")
        straight = {**changes, "src/saltus/ode/run.cpp": source.replace("  Run::one();\n", "").replace("  this->few();\n", "")}
        self.assertEqual(self.items("call_cycles", straight), {})

    def test_numbers_without_a_name(self):
        changes = {
            "src/saltus/ode/a.cpp": "constexpr double few = 1e-3;\nconstexpr std::array<double, 2> pair{\n    0.3,\n    0.4,\n};\n"
            'double rtol = 1e-6;\nconst double theirs{1e-6};\nauto text = "1e-9, 3.5";  // 7.5\nauto raw = R"(\n8.5\n)";\n'
            "int n = 1000 + 1'000;\ndouble a = x1 * 2.0 - 0.5 + 1.0e0;\n"
            "bool b = size < 1e-9 * x;\nconstexpr double f(double y) { return 3.5 * y - 3.5; }\n",
            "src/saltus/ode/x_tableau.hpp": "double c = f(0.37);\n",
        }
        found = self.items("numeric_literals", changes)
        self.assertEqual(found["ode, small"], ["src/saltus/ode/a.cpp:14: 1e-9"])
        self.assertEqual(found["ode"], ["src/saltus/ode/a.cpp:15: 3.5", "src/saltus/ode/a.cpp:15: 3.5 (number 2)"])

    def test_parts_without_a_test(self):
        changes = {
            "src/saltus/switching/plane/leaf.hpp": "struct Leaf {\n};\n",
            "src/saltus/switching/plane/leaf.cpp": "",
            "src/saltus/switching/plane/tree_internal.hpp": "int tree();\n",
            "src/saltus/switching/plane/branch.hpp": "class Branch {\n};\n",
            "src/saltus/switching/plane/branch_more.cpp": "int Branch::count() const {\n}\n",
            "src/saltus/switching/plane/root_more.cpp": "Kind Root::kind() const {\n}\n",
            "src/saltus/switching/face.hpp": "",
            "src/saltus/discretization/kernel.hpp": "",
            "src/saltus/discretization/ocp/problem.hpp": "",
            "tests/unit/switching/a_test.cpp": '#include "saltus/switching/plane/tree_internal.hpp"\nBranch branch;\n',
            "tests/unit/ode/a_test.cpp": "Leaf leaf;\n",
        }
        expected = {
            "discretization": ["src/saltus/discretization/ocp/problem"],
            "switching": ["src/saltus/switching/plane/leaf", "src/saltus/switching/plane/root_more"],
        }
        self.assertEqual(self.items("untested_parts", changes), expected)

    def test_places_of_mechanisms(self):
        begin = "bool begin_field(int& run) { return run > 0; }\nbool f(int& run) {\n  return begin_field(run);\n}\n"
        changes = {
            "src/saltus/event_integrator/instant/a.cpp": begin,
            "src/saltus/event_integrator/decide/b.cpp": "bool f(double v) { return v < rounding_of(1.0); }\n",
            "src/saltus/event_integrator/search/c.cpp": "bool f(double v) { return v < rounding_of(1.0); }\n",
            "src/saltus/event_integrator/contact/d.cpp": "bool Contacts::project(double t, double& x) {\n  return x > t;\n}\n",
            "src/saltus/switching/regions/region_decision.cpp": "int subsets();\n",
            "src/saltus/event_integrator/jumps/holding.cpp": '#include "saltus/switching/point/point_solver.hpp"\n',
        }
        expected = {
            "complementarity is solved": ["src/saltus/switching/regions/region_decision.cpp"],
            "modes begin": ["src/saltus/event_integrator/instant/a.cpp:3"],
            "states are projected": ["src/saltus/event_integrator/contact/d.cpp:1"],
            "zero is told from rounding": ["src/saltus/event_integrator/decide/b.cpp"],
        }
        self.assertEqual(self.items("mechanisms", changes), expected)

    def test_seconds_of_modules(self):
        lines = ("0\t900\t1\tCMakeFiles/saltus_ode.dir/a.o\tx", "0\t2000\t1\tCMakeFiles/saltus_ode.dir/b.o\tx",
                 "5\t1005\t1\tCMakeFiles/saltus_ode.dir/a.o\tx", "0\t500\t1\ttests/unit/CMakeFiles/a.dir/a.o\tx", "0\t9\t1\tlibode.a\tx")
        found = compile_seconds.seconds_of_modules("# ninja log v5\n" + "\n".join(lines))
        self.assertEqual(found, {"ode": (2, 3.0, 2.0), "tests/unit": (1, 0.5, 0.5)})


if __name__ == "__main__":
    unittest.main()

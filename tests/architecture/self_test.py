"""Shows that every architecture check accepts a good tree and complains about each kind of bad one."""

import unittest

import checks
from small_tree import GOOD, TABLE, Tree


class SelfTest(unittest.TestCase):
    def complaints(self, check, changes):
        with Tree(changes) as root:
            return checks.ALL_CHECKS[check](root, TABLE)

    def assert_complains(self, check, changes, *expected):
        found = self.complaints(check, changes)
        self.assertEqual(len(found), 1, found)
        for text in expected:
            self.assertIn(text, found[0])

    def test_good_tree_has_no_complaints(self):
        modules = "".join(f"saltus_module({name})\n" for name in ("io",))
        with Tree({"CMakeLists.txt": GOOD["CMakeLists.txt"] + modules.replace("io", "io LINKS base expression model")}) as root:
            for name, check in checks.ALL_CHECKS.items():
                self.assertEqual(check(root, TABLE), [], name)

    def test_include_against_the_direction(self):
        bad = '#pragma once\n\n#include "saltus/model/system.hpp"\n'
        self.assert_complains("include_directions", {"src/saltus/ode/bad.hpp": bad}, "ode/bad.hpp:3", "must not include")

    def test_engines_never_include_each_other(self):
        bad = '#include "saltus/event_integrator/integrate.hpp"\n'
        self.assert_complains("include_directions", {"src/saltus/fesd_integrator/a.cpp": bad}, "event_integrator")

    def test_base_includes_nothing(self):
        bad = '#include "saltus/result/result.hpp"\n'
        self.assert_complains("include_directions", {"src/saltus/base/a.cpp": bad}, "must not include result")

    def test_relative_include(self):
        changes = {"src/saltus/ode/stepper.hpp": "#pragma once\n", "src/saltus/ode/a.cpp": '#include "stepper.hpp"\n'}
        self.assert_complains("include_directions", changes, "full path")

    def test_generated_header(self):
        changes = {"src/saltus/report/a.cpp": '#include "script_of_the_page.hpp"\n'}
        self.assertEqual(self.complaints("include_directions", changes), [])

    def test_private_header_of_another_module(self):
        bad = '#include "saltus/model/hidden_internal.hpp"\n'
        self.assert_complains("include_directions", {"src/saltus/evaluation/a.cpp": bad}, "private to model")

    def test_module_that_nobody_listed(self):
        bad = "#include <vector>\n"
        self.assert_complains("include_directions", {"src/saltus/novel/a.hpp": bad}, "not in the table")

    def test_casadi_in_a_public_header(self):
        bad = "#include <casadi/core/sx.hpp>\n"
        self.assert_complains("third_party", {"src/saltus/evaluation/a.hpp": bad}, "CasADi", "public headers")

    def test_casadi_in_the_engine(self):
        bad = "#include <casadi/casadi.hpp>\n"
        self.assert_complains("third_party", {"src/saltus/event_integrator/a.cpp": bad}, "CasADi", "event_integrator")

    def test_toml_outside_io(self):
        for header in ("<toml++/toml.h>", "<toml++/toml.hpp>"):
            self.assert_complains("third_party", {"src/saltus/model/a.cpp": f"#include {header}\n"}, "toml++")

    def test_json_in_a_public_header(self):
        bad = "#include <nlohmann/json.hpp>\n"
        self.assert_complains("third_party", {"src/saltus/report/a.hpp": bad}, "nlohmann-json")

    def test_a_facade_beside_another_one(self):
        both = {f"src/saltus/report/{name}.cpp": "#include <nlohmann/json.hpp>\n" for name in "ab"}
        self.assert_complains("third_party", both, "nlohmann-json", "2 files")

    def test_command_line_outside_the_tool(self):
        self.assert_complains("third_party", {"src/saltus/pipeline/a.cpp": "#include <CLI/CLI.hpp>\n"}, "CLI11")

    def test_iostream_in_the_numerics(self):
        self.assert_complains("third_party", {"src/saltus/ode/a.cpp": "#include <iostream>\n"}, "iostream")

    def test_test_framework_in_the_library(self):
        self.assert_complains("third_party", {"src/saltus/ode/a.cpp": "#include <gtest/gtest.h>\n"}, "GoogleTest")

    def test_link_that_the_table_forbids(self):
        bad = GOOD["CMakeLists.txt"].replace("saltus_module(ode LINKS base)", "saltus_module(ode LINKS base model)")
        self.assert_links_complain(bad, "links model, which the table forbids")

    def test_link_that_is_missing(self):
        bad = GOOD["CMakeLists.txt"].replace("LINKS base model ode\n", "LINKS base ode\n")
        self.assert_links_complain(bad, "does not link model")

    def test_folder_without_target(self):
        bad = GOOD["CMakeLists.txt"].replace("saltus_module(ode LINKS base)\n", "")
        with Tree({"CMakeLists.txt": bad, "src/saltus/ode/stepper.hpp": "#pragma once\n"}) as root:
            self.assertIn("src/saltus/ode is not declared", "\n".join(checks.check_cmake_links(root, TABLE)))

    def assert_links_complain(self, cmake_lists, expected):
        found = self.complaints("cmake_links", {"CMakeLists.txt": cmake_lists + "saltus_module(io LINKS expression model)"})
        self.assertEqual(len(found), 1, found)
        self.assertIn(expected, found[0])

    def test_long_file(self):
        limit = TABLE["files"]["hard_limit_lines"]
        self.assertEqual(self.complaints("file_length", {"src/saltus/ode/a.cpp": "int a;\n" * limit}), [])
        self.assert_complains("file_length", {"src/saltus/ode/a.cpp": "int a;\n" * (limit + 1)}, f"{limit + 1} lines")

    def test_tableaus_may_be_long(self):
        self.assertEqual(self.complaints("file_length", {"src/saltus/ode/x_tableau.hpp": "int a;\n" * 2000}), [])

    def test_forbidden_words(self):
        for word in ("TO" + "DO", "FIX" + "ME", "XX" + "X"):
            bad = f"int a;  // {word}: later\n"
            self.assert_complains("forbidden_words", {"src/saltus/ode/a.cpp": bad}, "a.cpp:1", "issue")

    def test_unknown_citation(self):
        bibliography = "@article{hairer1993,\n title = {x}}\n"
        source = "// As in [hairer1993], but see [nobody2099].\n"
        changes = {"docs/references.bib": bibliography, "src/saltus/ode/a.cpp": source}
        self.assert_complains("citations", changes, "[nobody2099]")

    def test_index_is_no_citation(self):
        changes = {"docs/references.bib": "", "src/saltus/ode/a.cpp": "int b = a[x2024];  // a[i], [0, 1], [max]\n"}
        self.assertEqual(self.complaints("citations", changes), [])

    def unnamed(self, text):
        return "namespace saltus::ode {\nnamespace {\n\n" + text + "\n\n}  // namespace\n}  // namespace saltus::ode\n"

    def test_names_that_two_sources_of_a_folder_give(self):
        for one, other in (
            ("constexpr double tiny = 1e-9;", "constexpr double tiny = 1e-9;"),
            ("struct Value {\n  int a;\n};", "class Value;"),
            ("using Matrix = A;", "using Matrix = B;"),
            ("bool is_it(int a) { return a > 0; }", "template <class T>\nbool is_it(const T& a, int b) {\n}"),
            ("int first(int a);", "template <int n> int first(int a) {\n}"),
            ("const std::array<int, 2> pair{1, 2};", "std::pair<int, int> pair(int a,\n                         int b) {\n}"),
        ):
            changes = {"src/saltus/ode/a.cpp": self.unnamed(one), "src/saltus/ode/b.cpp": self.unnamed(other)}
            self.assert_complains("names_of_sources", changes, "b.cpp:", "a.cpp")
            apart = {"src/saltus/ode/a.cpp": self.unnamed(one), "src/saltus/io/b.cpp": self.unnamed(other)}
            self.assertEqual(self.complaints("names_of_sources", apart), [])

    def test_names_that_mean_the_same_or_are_not_of_the_folder(self):
        for text in (
            "using Rows = std::vector<double>;",
            "namespace fs = std::filesystem;",
            "using Eigen::Index;",
            "void Other::leave() {\n  int leave = 0;\n}",
        ):
            changes = {"src/saltus/ode/a.cpp": self.unnamed(text), "src/saltus/ode/b.cpp": self.unnamed(text)}
            self.assertEqual(self.complaints("names_of_sources", changes), [], text)

    def test_rooms_include_downwards_only(self):
        face = {"src/saltus/switching/plane/a.cpp": '#include "saltus/switching/table/b.hpp"\n'}
        self.assertEqual(self.complaints("rooms", face), [])
        self.assert_complains(
            "rooms", {"src/saltus/switching/table/a.cpp": '#include "saltus/switching/plane/b.hpp"\n'}, "a.cpp:1", "plane/b.hpp")
        self.assert_complains("rooms", {"src/saltus/switching/cellar/a.cpp": "\n"}, "room cellar", "not in the table")
        self.assert_complains(
            "rooms", {"src/saltus/event_integrator/mode/a.cpp": '#include "saltus/event_integrator/integrate.hpp"\n'}, "mode")
        types = {"src/saltus/event_integrator/mode/a.cpp": '#include "saltus/event_integrator/options.hpp"\n'}
        self.assertEqual(self.complaints("rooms", types), [])

    def test_installed_headers_include_installed_ones(self):
        declared = {"CMakeLists.txt": "saltus_module(switching FACE LINKS base)\n", "src/saltus/switching/plane/b.hpp": ""}
        for name in ("saltus/switching/plane/b.hpp", "saltus/ode/steps_internal.hpp"):
            changes = {**declared, "src/saltus/ode/a.hpp": f'#include "{name}"\n'}
            self.assert_complains("installed_headers", changes, "a.hpp:1", name)
            inside = {**declared, "src/saltus/ode/a.cpp": f'#include "{name}"\n'}
            self.assertEqual(self.complaints("installed_headers", inside), [])

    def test_folders_with_too_many_files(self):
        many = {f"src/saltus/io/file{i}.hpp": "" for i in range(41)}
        self.assert_complains("files_in_folder", many, "src/saltus/io", "43 files")

    def test_functions_longer_than_a_screen(self):
        for head in ("int f(int a) {", "int Run::f(int a,\n           int b) {", "double f() const noexcept {"):
            long = {"src/saltus/ode/a.cpp": head + "\n" + "  g();\n" * 60 + "}\n"}
            self.assert_complains("function_length", long, "a.cpp:1", "f has")
            short = {"src/saltus/ode/a.cpp": head + "\n" + "  g();\n" * 40 + "}\n"}
            self.assertEqual(self.complaints("function_length", short), [])
        inside = {"src/saltus/ode/a.hpp": "struct A {\n  int f() {\n" + "    g();\n" * 60 + "  }\n};\n"}
        self.assert_complains("function_length", inside, "a.hpp:2", "f has 62")

    def test_functions_with_many_ways(self):
        branches = "  if (a && b) f();\n" * 10
        name = "src/saltus/switching/a.cpp"
        self.assert_complains("ways", {name: f"void f() {{\n{branches}}}\n"}, "a.cpp:1", "f has 21")
        fewer = branches.replace(" && b", "", 1) + "  // if\n  text(\" ? \");\n"
        self.assertEqual(self.complaints("ways", {name: f"void f() {{\n{fewer}}}\n"}), [])

    def test_writers_of_the_position(self):
        name = "src/saltus/event_integrator/run/a.cpp"
        self.assert_complains("position", {name: "  here_.t = t_new;\n"}, "a.cpp:1", "move_to")
        self.assertEqual(self.complaints("position", {name: "  if (here_.t == t) here_.move_to(t, x);\n"}), [])

    def test_classes_that_hold_everything(self):
        members = "".join(f"  std::vector<double> member{i}_{{1.0, 2.0}};  ///< a(b)\n" for i in range(25))
        full = "class A {\n public:\n  void f(int a);\n\n private:\n" + members
        self.assertEqual(self.complaints("data_members", {"src/saltus/ode/a.hpp": full + "};\n"}), [])
        more = full + "  double a_ = 0.0, b_ = 1.0;\n};\n"
        self.assert_complains("data_members", {"src/saltus/ode/a.hpp": more}, "A has 27")
        data = more.replace("class A", "struct A").replace("  void f(int a);\n", "")
        self.assertEqual(self.complaints("data_members", {"src/saltus/ode/a.hpp": data}), [])

    def assert_sentences(self, text, *expected):
        found = self.complaints("comment_sentences", {"src/saltus/ode/a.cpp": text})
        self.assertEqual(len(found), len(expected), found)
        for complaint, part in zip(found, expected):
            self.assertIn(part, complaint)

    def test_long_sentences(self):
        limit = TABLE["sizes"]["words_in_sentence"]
        short, long = "word " * (limit - 1) + "end", "word " * limit + "end"
        for comment in (f"// {short}.", f"int a;  ///< {short}", f"/// - {short}.\n/// - {short}.", f"/// {short};\n/// {short}."):
            self.assert_sentences(comment + "\n")
        half = "word " * (limit // 2 + 1)
        for comment, line in (
            (f"int b;\n// {long}.", 2),
            (f"int a;  ///< {long}", 1),
            (f"/// {half}\n/// {half}", 1),
            (f"int a;  // {half}\n        // {half}", 1),
            (f"/// First.\n/// - {half}\n///   {half}", 2),
            (f"/// @param x, y  {half}\n///              {half}", 1),
        ):
            self.assert_sentences(comment + "\n", f"a.cpp:{line}: {limit + 1 if long in comment else 2 * (limit // 2 + 1)} words")

    def test_what_is_no_sentence(self):
        half = "word " * 20
        for text in (
            f"/// With\n///   x = {half},\n///   y = {half}\n/// {half}",  # displayed lines
            f"/// {half}\n///\n/// {half}",  # paragraphs
            f"/// {half} ({half} (and so on)) end.",
            f'auto a = "// {half} {half}";',
            f'auto a = R"(\n// {half} {half}\n)";',
            f"int a;  // {half}\nint b;  // {half}",
        ):
            self.assert_sentences(text + "\n")

    def test_ellipses(self):
        for formula in ("k_1, ..., k_m", "m = 1 ... n", "c0 + c1 r + ...", "t_0 < … < t_n", "psi_0 … psi_n", "f(x_0, ...)"):
            self.assert_sentences(f"/// Numbers {formula} of it.\n")
        for prose in ("states, controls, ...", "What it sets …", "… and their values", "{ initial = … }", "if(...)"):
            self.assert_sentences(f"int a;  ///< {prose}\n", "an ellipsis")

    def test_pages_name_files_that_are_there(self):
        good = "`ode/stepper.cpp`, `stepper.cpp`, `ode/stepper`, `io/hidden`, `src/saltus/ode/`, `tl/expected.hpp`, `a / b`\n"
        changes = {"ARCHITECTURE.md": good, "src/saltus/ode/README.md": "`stepper.cpp`\n"}
        self.assertEqual(self.complaints("named_files", changes), [])
        for bad in ("`stepper.py`", "`io/stepper.cpp`", "`ode/steps`"):
            self.assert_complains("named_files", {"ARCHITECTURE.md": "one\n" + bad + "\n"}, "ARCHITECTURE.md:2", "there is no")


if __name__ == "__main__":
    unittest.main()

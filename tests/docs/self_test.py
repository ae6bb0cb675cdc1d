"""Shows what check_claims.py and the small checks of scripts/ (workflows, stray logs, notes of a release) complain about."""

import contextlib
import io
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import check_claims

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import check_workflows  # noqa: E402
import name_urls  # noqa: E402
import release_notes  # noqa: E402
import stray_logs  # noqa: E402

PAGE = "---\nkey: x\n---\n# Title\n\nIt finds every zero, and\nsays so. It is written in C++.\n\n```\nnever run\n```\n\n- A list with `code` in it.\n"
CLAIMS = "# Claims\n\n## README.md\n\n> It finds every zero,\n> and says so.\n\n- `tests/a_test.cpp::Finds`, `tests/`\n\n## docs/index.md\n\n> It is written in C++.\n\n- `benchmarks/b.py`\n"
FILES = {"README.md": PAGE, "docs/index.md": "It is written in C++.\n", "CLAIMS.md": CLAIMS, "tests/a_test.cpp": "TEST(A, Finds) {}\n",
         "benchmarks/b.py": ""}


class ClaimsSelfTest(unittest.TestCase):
    def complaints(self, **changes):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in {**FILES, **{name.replace("__", "/") + ".md": text for name, text in changes.items()}}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text, encoding="utf-8")
            return list(check_claims.complaints(root))

    def assert_complains(self, expected, **changes):
        found = self.complaints(**changes)
        self.assertEqual(len(found), 1, found)
        self.assertIn(expected, found[0])

    def test_what_is_said_and_shown(self):
        self.assertEqual(self.complaints(), [])

    def test_sentences_are_found_across_lines_and_not_in_code(self):
        self.assertEqual(check_claims.sentences(PAGE), ["It finds every zero, and says so.", "It is written in C++.", "A list with `code` in it."])

    def test_a_sentence_that_has_changed(self):
        self.assert_complains("does not say 'It is written in C++.'", docs__index="It is written.\n")

    def test_a_test_that_has_gone(self):
        self.assert_complains("a_test.cpp has no Loses", CLAIMS=CLAIMS.replace("Finds", "Loses"))
        self.assert_complains("there is no benchmarks/c.py", CLAIMS=CLAIMS.replace("b.py", "c.py"))
        self.assert_complains("nothing shows 'It is written", CLAIMS=CLAIMS.replace("`benchmarks/b.py`", "by reading"))

    def test_figures_are_those_of_their_page(self):
        row = "\n| Measured | Us | Others | Page |\n|---|---|---|---|\n| time | {} ms | A 21.8 ms | [b](benchmarks/results/b.md) |\n"
        files = {"benchmarks__all": "x", "benchmarks__results__b": "| 1.5 ms | 21.8 ms |\n"}
        FILES["benchmarks/all.py"] = 'Benchmark("b")'
        self.addCleanup(FILES.pop, "benchmarks/all.py")
        self.assertEqual(self.complaints(README=PAGE + row.format("1.5"), **files), [])
        self.assert_complains("b.md has no 1.4", README=PAGE + row.format("1.4"), **files)
        FILES["benchmarks/all.py"] = 'Benchmark("c")'
        self.assert_complains("does not repeat 'b'", README=PAGE + row.format("1.5"), **files)

    def test_a_new_promise(self):
        self.assert_complains("what shows 'It never fails.'", README=PAGE + "\nIt never fails.\n")


class ScriptsSelfTest(unittest.TestCase):
    def test_every_benchmark_has_its_script_and_its_page(self):
        root = Path(__file__).resolve().parents[2]
        sys.path.insert(0, str(root / "benchmarks"))
        import all as every

        names = [one.name for one in every.benchmarks("folder")]
        self.assertEqual(len(set(names)), len(names))
        for one in every.benchmarks("folder"):
            self.assertTrue((root / "benchmarks" / one.script).exists(), one.script)
            self.assertTrue((root / f"benchmarks/results/{one.name}.md").exists(), one.name)

    def test_workflows_call_what_is_there(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / ".github/workflows").mkdir(parents=True)
            (root / "scripts").mkdir()
            (root / "scripts/a.sh").write_text("", encoding="utf-8")
            (root / ".github/workflows/ci.yml").write_text("run: scripts/a.sh && python3 scripts/b.py x\n", encoding="utf-8")
            for name in (".pre-commit-config.yaml", "pyproject.toml"):
                (root / name).write_text("", encoding="utf-8")
            self.assertEqual(list(check_workflows.missing_files(root)), [".github/workflows/ci.yml: there is no scripts/b.py"])

    def test_addresses_of_a_release_are_those_of_its_repository(self):
        root = Path(__file__).resolve().parents[2]
        addresses = name_urls.urls("Group", "saltus")
        self.assertEqual(addresses["Documentation"], "https://group.github.io/saltus/")
        once = name_urls.with_urls((root / "pyproject.toml").read_text(encoding="utf-8"), addresses)
        self.assertEqual(name_urls.with_urls(once, addresses), once)
        self.assertEqual(tomllib.loads(once)["project"]["urls"], addresses)
        header = (root / "src/saltus/base/docs_page.hpp").read_text(encoding="utf-8")
        self.assertIn('docs_address = "https://a/"', name_urls.with_address(header, "https://a/"))

    def test_logs_and_results_are_stray(self):
        for name, code in (("build.log", 1), ("a/b.log", 1), ("result.json", 1), ("a/x.orig", 1), ("CMakePresets.json", 0), ("tests/r.json", 0)):
            with contextlib.redirect_stdout(io.StringIO()):
                self.assertEqual(stray_logs.main([name]), code, name)

    def test_notes_are_the_section_of_the_version(self):
        changelog = "# Changelog\n\n## Unreleased\n\nnew\n\n## 0.1.10\n\nten\n\n## 0.1.1 (2026)\n\n### Added\n- one\n"
        self.assertEqual(release_notes.notes(changelog, "0.1.1"), "### Added\n- one")
        self.assertIsNone(release_notes.notes(changelog, "0.1"))
        self.assertIsNone(release_notes.notes(changelog, "0.2.0"))


if __name__ == "__main__":
    unittest.main()

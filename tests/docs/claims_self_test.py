"""Shows that check_claims.py sees a claim that is no longer said, one that nothing shows, and one that is new."""

import tempfile
import unittest
from pathlib import Path

import check_claims

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

    def test_a_new_promise(self):
        self.assert_complains("what shows 'It never fails.'", README=PAGE + "\nIt never fails.\n")


if __name__ == "__main__":
    unittest.main()

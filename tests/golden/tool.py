"""Runs the tool for the golden tests: argv is the tool and the source tree."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = sys.argv[1]
SOURCE = pathlib.Path(sys.argv[2])


class ToolTest(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="saltus-golden-")
        self.folder = pathlib.Path(self._folder.name)

    def tearDown(self):
        self._folder.cleanup()

    def run_tool(self, *arguments, code, environment=None):
        """Runs the tool in the test's folder, expects an exit code, returns standard output and standard error."""
        done = subprocess.run([TOOL, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              env=os.environ | (environment or {}), timeout=120)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done.stdout, done.stderr

    def write(self, name, text):
        path = self.folder / name
        if isinstance(text, bytes):
            path.write_bytes(text)
        else:
            path.write_text(text, encoding="utf-8")
        return path


class ResultTest(ToolTest):
    def result(self, text, *arguments, code=0):
        """The result of a model that stands in a text."""
        self.run_tool("simulate", self.write("m.toml", text), "--out", "r.json", *arguments, code=code)
        return json.loads((self.folder / "r.json").read_text())


def main():
    unittest.main(argv=[sys.argv[0], "-v"])

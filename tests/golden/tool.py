"""Runs the tool for the golden tests: argv is the tool and the source tree.

Limits are against hanging, not against slowness: a run may compute ten times as long as the longest one does under the
sanitizers, however long that takes on a busy machine, and a process that is told to end may wait as long."""

import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
import unittest

TOOL = sys.argv[1]
SOURCE = pathlib.Path(sys.argv[2])
CPU_SECONDS = 600
WAIT = 600  # seconds of the clock, for a process that has nothing left to compute
SANITIZED = b"__asan_init" in pathlib.Path(TOOL).read_bytes()

# For tests that take minutes under the sanitizers and find nothing new there.
not_sanitized = unittest.skipIf(SANITIZED, "takes long with a sanitized tool")


def some(cases, number):
    """All cases, or the first ones with a sanitized tool, which takes ten times as long."""
    return list(cases)[:number] if SANITIZED else list(cases)


def limit_cpu():
    """What a child process does before it becomes the tool: SIGXCPU ends it at its limit."""
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 10))


def cpu_seconds(process):
    """What a process has computed so far; infinite where the system does not say."""
    try:
        fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return float("inf")
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def wait_for_cpu(process, seconds):
    """Lets a process compute so long: on a busy machine that takes longer by the clock."""
    end = time.monotonic() + WAIT
    time.sleep(seconds)
    while process.poll() is None and cpu_seconds(process) < seconds and time.monotonic() < end:
        time.sleep(0.05)


class ToolTest(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="saltus-golden-")
        self.folder = pathlib.Path(self._folder.name)

    def tearDown(self):
        self._folder.cleanup()

    def run_tool(self, *arguments, code, environment=None):
        """Runs the tool in the test's folder, expects an exit code, returns standard output and standard error."""
        done = subprocess.run([TOOL, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              env=os.environ | (environment or {}), preexec_fn=limit_cpu)
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

"""Ctrl-C: stops at the next step, what was computed is written; progress only where somebody looks."""

import json
import os
import signal
import subprocess
import time
import unittest

import tool

try:
    import pty
except ImportError:  # a system without pseudo-terminals
    pty = None

ENDLESS = """
[model]
name = "endless"
[states]
x = 1
v = 0
[dynamics]
x = "v"
v = "-x"
[simulate]
until = 1e9
max_steps = 1000000000
output = { points = 10 }
"""


class Interrupt(tool.ToolTest):
    def start(self, command=("simulate", "--out", "r.json"), **streams):
        model = self.write("m.toml", ENDLESS)
        return subprocess.Popen([tool.TOOL, *command, str(model)], cwd=self.folder, **streams)

    def terminal(self):
        """Both ends of a pseudo-terminal; containers without /dev/ptmx have none."""
        if pty is None:
            self.skipTest("this system has no pseudo-terminals")
        try:
            return pty.openpty()
        except OSError as failure:
            self.skipTest(f"no pseudo-terminal can be opened here: {failure}")

    def test_a_violated_contract_ends_with_the_code_of_an_internal_error(self):
        process = self.start(stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        tool.wait_for_cpu(process, 1.0)
        self.assertIsNone(process.poll(), "ended by itself")
        process.send_signal(signal.SIGABRT)  # what std::abort sends
        self.assertEqual(process.wait(timeout=tool.WAIT), 1)

    def test_the_first_one_stops_and_writes(self):
        process = self.start(stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        tool.wait_for_cpu(process, 2.0)
        self.assertIsNone(process.poll(), "ended by itself")
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=tool.WAIT)
        self.assertEqual(process.returncode, 3, err)
        self.assertIn("stopped_by_user", out)
        self.assertIn("stopped_by_user", err)
        self.assertNotIn("%", err)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertEqual(result["status"]["termination"], "stopped_by_user")
        self.assertGreater(result["final"]["t"], 0.0)
        self.assertLess(result["final"]["t"], 1e9)
        self.assertEqual(result["trajectory"]["t"][-1], result["final"]["t"])

    def test_a_sweep_writes_the_runs_that_began(self):
        process = self.start(["sweep", "--over", "x=0:1:10000", "--set", "simulate.until=10000", "--out", "s.csv"],
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        tool.wait_for_cpu(process, 3.0)
        self.assertIsNone(process.poll(), "ended by itself")
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=tool.WAIT)
        self.assertEqual(process.returncode, 3, err)
        rows = (self.folder / "s.csv").read_text(encoding="utf-8").splitlines()[1:]
        self.assertIn(f"{len(rows)} of 10000 runs began: the others have no rows", err)
        self.assertIn(f"{len(rows)} runs: ", out)
        self.assertTrue(0 < len(rows) < 10000)
        self.assertEqual([row.split(",")[0] for row in rows], [str(i + 1) for i in range(len(rows))])

    def test_while_writing_nothing_is_left(self):
        self.write("m.toml", ENDLESS.replace("1e9\n", "1000\n").replace("points = 10", "points = 1000000"))
        self.write("r.json", "precious")
        process = subprocess.Popen([tool.TOOL, "simulate", "m.toml", "--out", "r.json"], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while not any(path.stat().st_size > 0 for path in self.folder.glob("r.json.part")):
            self.assertIsNone(process.poll(), "ended by itself")
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=tool.WAIT)
        self.assertEqual(process.returncode, 3, err)
        self.assertIn("writing r.json was interrupted", err)
        self.assertEqual((self.folder / "r.json").read_text(), "precious")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["m.toml", "r.json"])

    def test_a_page_is_left_out_by_a_second_one(self):
        # Many events: their page takes seconds.
        self.write("m.toml", ENDLESS.replace('"-x"', '"-sign(x)"').replace("max_steps", "max_events = 1000000000\nmax_steps"))
        process = subprocess.Popen([tool.TOOL, "simulate", "m.toml", "--report", "r.html"], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        tool.wait_for_cpu(process, 6.0)
        self.assertIsNone(process.poll(), "ended by itself")
        process.send_signal(signal.SIGINT)
        said = process.stderr.readline()
        self.assertIn("writing r.html; Ctrl-C once more leaves it out", said)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=tool.WAIT)
        self.assertEqual(process.returncode, 3, err)
        self.assertIn("writing r.html was interrupted", err)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["m.toml"])

    def test_check_says_what_it_knows(self):
        process = self.start(["check", "--well-posedness"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        tool.wait_for_cpu(process, 2.0)
        self.assertIsNone(process.poll(), "ended by itself")
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=tool.WAIT)
        self.assertEqual(process.returncode, 3, err)
        self.assertIn("the simulation stopped at t = ", out)
        self.assertIn("stopped_by_user", err)

    def test_a_model_that_is_prepared_says_so_and_can_be_stopped(self):
        n = 300
        terms = ["".join(f"{1 + 0.01 * ((7 * i + 3 * j) % 11):+}*max(x{j}-0.5,0)" for j in range(n)) for i in range(n)]
        states = "".join(f"x{i} = 1\n" for i in range(n))
        rates = "".join(f'x{i} = "-9*x{i}{terms[i]}"\n' for i in range(n))
        self.write("m.toml", f'[model]\nname = "dense"\n[states]\n{states}[dynamics]\n{rates}[simulate]\nuntil = 1\n')
        seen, shown = self.terminal()
        process = subprocess.Popen([tool.TOOL, "simulate", "m.toml", "--out", "r.json"], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=shown)
        os.close(shown)
        text = b""
        while b"preparing" not in text:
            text += os.read(seen, 4096)
        process.send_signal(signal.SIGINT)
        while True:
            try:
                text += os.read(seen, 4096)
            except OSError:  # the other side closed
                break
        os.close(seen)
        self.assertEqual(process.wait(timeout=tool.WAIT), 3)
        self.assertRegex(text.decode(), r"\rpreparing   [a-z -]+: \d+ of \d+")
        self.assertIn("stopped while the model was prepared", text.decode())
        self.assertFalse((self.folder / "r.json").exists())

    def test_a_terminal_sees_progress(self):
        seen, shown = self.terminal()
        process = self.start(stdout=subprocess.DEVNULL, stderr=shown)
        os.close(shown)
        text = b""
        while b" %" not in text:
            text += os.read(seen, 4096)
        process.send_signal(signal.SIGINT)
        while True:
            try:
                text += os.read(seen, 4096)
            except OSError:  # the other side closed
                break
        self.assertEqual(process.wait(timeout=tool.WAIT), 3)
        os.close(seen)
        self.assertRegex(text.decode(), r"\rt = [0-9.e+]+   0 %   \d+ steps   0 events")


if __name__ == "__main__":
    tool.main()

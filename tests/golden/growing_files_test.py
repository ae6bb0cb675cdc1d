"""Files of --out that are written while a run goes on: equal to those that are written at its end, and readable before."""

import csv
import json
import os
import resource
import signal
import subprocess
import time

import tool

# Events, sliding phases, an output.
MODEL = """
[model]
name = "relay"
[parameters]
k = 2.0
[states]
x = 1.0
v = 0.0
[dynamics]
x = "v"
v = "-x - 0.1*v - k*sign(v + 0.3*x - 0.5*sin(3*t))"
[outputs]
energy = "0.5*(x^2 + v^2)"
[simulate]
until = 300
"""
LONG = """
[model]
name = "driven"
[states]
x = 1
v = 0
[dynamics]
x = "v"
v = "-x - 0.01*sign(v) + 0.1*sin(0.7*t)"
[simulate]
until = UNTIL
max_steps = 1000000000
max_events = 100000000
"""

# Nine rows to an event.
PARABOLAS = """
[model]
name = "parabolas"
[states]
x = 1
v = 0
[dynamics]
x = "v"
v = "-sign(x)"
[simulate]
until = 1.6e5
max_events = 100000
"""


def numbers(path):
    """A result without what depends on the call and the clock."""
    result = json.loads(path.read_text(encoding="utf-8"))
    result["statistics"].pop("wall_seconds")
    result.pop("command_line")
    result.pop("date")
    return result


class GrowingFiles(tool.ToolTest):
    def both(self, *words):
        """The files as they grow, and as they are written at the end: a page needs the whole result."""
        self.write("m.toml", MODEL)
        names = [word for name in ("{}.json", "{}.csv", "{}.events.csv", "{}.npz") for word in ("--out", name)]
        self.run_tool("simulate", "m.toml", *words, *(word.format("grown") for word in names), code=0)
        self.run_tool("simulate", "m.toml", *words, *(word.format("whole") for word in names), "--report", "r.html",
                      code=0)
        return [(self.folder / f"grown{suffix}", self.folder / f"whole{suffix}")
                for suffix in (".json", ".csv", ".events.csv", ".npz")]

    def test_grown_files_are_those_written_at_the_end(self):
        for words in ([], ["--set", "simulate.output=steps"], ["--set", "simulate.output.every=0.01"],
                      ["--set", "simulate.output.every=0.01", "--set", "simulate.output.events=false"],
                      ["--set", "simulate.output.events=false"], ["--until", "0.01"]):
            with self.subTest(words=words):
                (grown, whole), *tables = self.both(*words)
                self.assertEqual(numbers(grown), numbers(whole))
                for ours, theirs in tables:
                    self.assertEqual(ours.read_bytes(), theirs.read_bytes())
        self.assertEqual([path.name for path in self.folder.glob("*.part")], [])

    def test_the_table_is_the_same(self):
        self.write("m.toml", MODEL)
        grown, _ = self.run_tool("simulate", "m.toml", "--out", "r.csv", code=0)
        whole, _ = self.run_tool("simulate", "m.toml", code=0)
        without_time = [[line for line in text.splitlines() if "evaluations" not in line] for text in (grown, whole)]
        self.assertEqual(*without_time)

    def test_what_is_killed_leaves_its_rows(self):
        self.write("m.toml", LONG.replace("UNTIL", "1e7"))
        process = subprocess.Popen([tool.TOOL, "simulate", "m.toml", "--quiet", "--out", "r.csv"], cwd=self.folder)
        part = self.folder / "r.csv.part"
        while not (part.exists() and part.stat().st_size > 100000):
            self.assertIsNone(process.poll(), "ended by itself")
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
        process.wait(timeout=tool.WAIT)
        self.assertFalse((self.folder / "r.csv").exists())
        head, *lines = part.read_text(encoding="utf-8").splitlines()
        self.assertEqual(head, "t,side,x,v,alpha(v),mode(v)")
        rows = list(csv.reader(lines[:-1]))  # the last one may be cut off
        self.assertGreater(len(rows), 100)
        self.assertTrue(all(len(row) == 6 for row in rows))

    def test_a_request_to_end_is_like_ctrl_c(self):
        self.write("m.toml", LONG.replace("UNTIL", "1e7"))
        process = subprocess.Popen([tool.TOOL, "simulate", "m.toml", "--quiet", "--out", "r.json"], cwd=self.folder,
                                   stderr=subprocess.DEVNULL)
        tool.wait_for_cpu(process, 2.0)
        self.assertIsNone(process.poll(), "ended by itself")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=tool.WAIT), 3)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertEqual(result["status"]["termination"], "stopped_by_user")
        self.assertEqual(result["trajectory"]["t"][-1], result["final"]["t"])

    def test_memory_does_not_grow_with_the_rows(self):
        # The address sanitizer keeps what is freed: its peaks say nothing.
        if tool.SANITIZED:
            self.skipTest("a sanitized tool")
        self.write("m.toml", LONG.replace("UNTIL", "2000"))
        peaks = []
        for rows in (2_000, 500_000):
            process = subprocess.Popen([tool.TOOL, "simulate", "m.toml", "--quiet", "--out", "r.csv", "--out", "r.json",
                                        "--out", "r.npz", "--set", f"simulate.output.points={rows}"], cwd=self.folder)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status
            self.assertEqual(status, 0)
            peaks.append(usage.ru_maxrss / 1024)
        # The times that are asked for are there: 8 bytes for each row; and a block of the archive.
        self.assertLess(peaks[1], peaks[0] + 40, peaks)

    @tool.not_sanitized
    def test_rows_between_very_many_events_are_thinned(self):
        self.write("m.toml", PARABOLAS)
        table, notes = self.run_tool("simulate", "m.toml", "--out", "r.json", "--out", "r.events.csv", code=0)
        # The file is announced when it gets large, before it is written.
        self.assertRegex(notes, r"note: r.json grows beyond 50 MB; .*npz.*simulate.output.points=1000 .*simulate.output.states=x1 .*\nnote: r.json has \d+ MB\n")
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        rows, thinned_from = result["trajectory"]["t"], result["statistics"]["thinned_from"]
        times = [event["t"] for event in result["events"]]
        self.assertLess(len(rows), 2 * 250_000 + 2 * len(times))
        self.assertIn("rows        those between events are thinned from t = ", table)
        at_events = {*times, rows[-1]}
        self.assertGreaterEqual(min(b - a for a, b in zip(rows, rows[1:]) if a > thinned_from and b not in at_events),
                                rows[-1] / 250_000)
        self.assertEqual(sum(a == b for a, b in zip(rows, rows[1:])), len(times))
        self.run_tool("simulate", "m.toml", "--quiet", "--set", "simulate.output=steps", "--out", "s.events.csv", code=0)
        self.assertEqual((self.folder / "r.events.csv").read_bytes(), (self.folder / "s.events.csv").read_bytes())

    def test_rows_that_cannot_be_put_aside_say_why(self):
        self.write("m.toml", LONG.replace("UNTIL", "3000"))
        limit = 3_000_000  # bytes of any file: the rows of the archive are put aside before it is written
        for name in ("r.npz", "r.json"):
            process = subprocess.run([tool.TOOL, "simulate", "m.toml", "--quiet", "--out", name,
                                      "--set", "simulate.output.points=500000"], cwd=self.folder, text=True,
                                     capture_output=True, timeout=tool.WAIT,
                                     preexec_fn=lambda: (signal.signal(signal.SIGXFSZ, signal.SIG_IGN),
                                                         resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))))
            self.assertEqual(process.returncode, 2, process.stderr)
            self.assertIn("rows cannot be put aside in folder '.': File too large", process.stderr)
            self.assertFalse((self.folder / name).exists())


if __name__ == "__main__":
    tool.main()

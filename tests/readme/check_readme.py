"""Runs what README.md and docs/start.md show: models and commands, and compares what they say about the results.

usage: check_readme.py README.md TOOL
"""

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path


def blocks(text, language):
    """Contents of the fenced blocks of a language; fences open and close in turn."""
    found, current = [], None
    for line in text.splitlines():
        if line.startswith("```"):
            if current is None:
                current = (line[3:].strip(), [])
            else:
                found.append(current)
                current = None
        elif current is not None:
            current[1].append(line)
    return ["\n".join(lines) for name, lines in found if name == language]


def run(command, tool, folder):
    """A command line of the README, with the tool that was built."""
    words = [tool, *command.split()[1:]]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{command}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def main(readme, tool):
    text = Path(readme).read_text(encoding="utf-8")
    missing = [link for link in re.findall(r"\]\(([^)#:]+)\)", text) if not (Path(readme).parent / link).exists()]
    if missing:
        sys.exit(f"README.md links to what is not there: {missing}")
    (model,) = blocks(text, "toml")
    start = (Path(readme).parent / "docs/start.md").read_text(encoding="utf-8")
    (problem,) = blocks(start, "toml")
    name = re.search(r"Save it as `([^`]+)`", text).group(1)
    example = re.search(r"`(examples/optimize/[^`]+)` without its remarks", start).group(1)
    commands = [line for block in blocks(text, "") for line in block.splitlines() if line.startswith("saltus ")]
    if not commands:
        sys.exit("README.md shows no saltus command")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / name).write_text(model, encoding="utf-8")
        (Path(folder) / Path(example).name).write_text(problem, encoding="utf-8")
        for command in commands:
            run(command, tool, folder)
        run(f"saltus simulate {name} --quiet --out result.json", tool, folder)
        result = json.loads((Path(folder) / "result.json").read_text(encoding="utf-8"))
        optima = []
        for file in (Path(example).name, Path(readme).parent.resolve() / example):
            run(f"saltus optimize {file} --quiet --out optimum.json", tool, folder)
            optima.append(json.loads((Path(folder) / "optimum.json").read_text(encoding="utf-8"))["horizon"])
    least = float(re.search(r"It takes ([0-9.]+) time units", start).group(1))
    if abs(optima[0] - least) > 0.001 or abs(optima[0] - optima[1]) > 1e-9:
        sys.exit(f"docs/start.md claims a least time of {least}; its problem has {optima[0]}, the example {optima[1]}")
    claimed = float(re.search(r"stops after ([0-9.]+) time units", text).group(1))
    events = result["events"]
    if len(events) != 1 or events[0]["kind"] != "enter_sliding" or abs(events[0]["t"] - claimed) > 0.01:
        sys.exit(f"README.md claims one event at {claimed}; got {[(e['t'], e['kind']) for e in events]}")
    if result["final"]["x"][1] != 0.0:
        sys.exit(f"README.md says that the mass sticks; its velocity is {result['final']['x'][1]}")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])

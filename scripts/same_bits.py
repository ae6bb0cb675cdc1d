"""Compares the results of two builds of the tool, bit for bit.

usage: same_bits.py OLD NEW [--only WORD] [--engine event|fesd] [--seconds S] [--tests]

Runs all models of the catalogue with every integrator of the event engine and in both forms of FESD. With --tests, models
that stand as text in the sources of tests/ are run, too, with the default integrator. Times, versions and the place of the
tool are left out of the comparison. Prints what differs; exit code 1 if anything does.
"""

import argparse
import concurrent.futures
import hashlib
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

LEFT_OUT = {"saltus", "record_sha256", "command_line", "wall_seconds", "date", "text", "file", "host", "version",
            "equations", "captions"}  # of the model, not of its solution
INTEGRATORS = ("dopri5", "dop853", "radau5", "taylor")
EVENT = [["--method", "event", "--integrator", name, "--set", "simulate.max_steps=20000"] for name in INTEGRATORS]
FESD = [["--method", "fesd", "--set", f"simulate.fesd.reformulation={form}", "--set", "simulate.max_steps=60"]
        for form in ("step", "stewart")]
RAW_TEXT = re.compile(r'R"(\w*)\((.*?)\)\1"|"""(.*?)"""', re.DOTALL)


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(item) for key, item in value.items() if key not in LEFT_OUT}
    return [without_times(item) for item in value] if isinstance(value, list) else value


def result_of(tool, model, options, seconds):
    """What a run says, or None where it takes longer than `seconds`."""
    try:
        run = subprocess.run([tool, "simulate", model, "--quiet", *options, "--out", "-"], capture_output=True, text=True,
                             timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return None
    if run.returncode not in (0, 3):
        return {"exit": run.returncode, "message": run.stderr}
    return without_times(json.loads(run.stdout))


def difference(old, new, place=""):
    """Where two results differ first, or None."""
    if isinstance(old, dict) and isinstance(new, dict) and old.keys() == new.keys():
        pairs = [(f"{place}.{key}", old[key], new[key]) for key in old]
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        pairs = [(f"{place}[{number}]", *pair) for number, pair in enumerate(zip(old, new))]
    else:
        # repr: 0 and -0 differ, NaN is NaN
        return None if repr(old) == repr(new) else f"{place}: {str(old)[:150]} became {str(new)[:150]}"
    return next((found for pair in pairs if (found := difference(pair[1], pair[2], pair[0]))), None)


def models_in_tests(folder):
    """Model files made of the model texts in the sources of the tests."""
    for source in sorted(Path("tests").rglob("*")):
        if source.suffix not in (".cpp", ".hpp", ".py"):
            continue
        for match in RAW_TEXT.finditer(source.read_text(encoding="utf-8")):
            text = match.group(2) or match.group(3) or ""
            if "[states]" not in text or "[dynamics]" not in text and "[mechanics]" not in text:
                continue
            path = folder / f"{source.stem}-{hashlib.sha256(text.encode()).hexdigest()[:8]}.toml"
            path.write_text(text if "[model]" in text else f'[model]\nname = "{source.stem}"\n{text}', encoding="utf-8")
            yield str(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--only", default="", help="models with this in their name")
    parser.add_argument("--engine", choices=("event", "fesd"), help="one engine only")
    parser.add_argument("--seconds", type=float, default=20.0, help="longest run; what takes longer is not compared")
    parser.add_argument("--tests", action="store_true", help="models in the sources of tests/, too")
    arguments = parser.parse_args()

    listed = subprocess.run([arguments.old, "models"], capture_output=True, text=True, check=True).stdout
    listed = listed.partition("\n\n")[0]
    ways = {"event": EVENT, "fesd": FESD}.get(arguments.engine, EVENT + FESD)
    runs = [(line.split()[0], options) for line in listed.splitlines() if line.strip() for options in ways]
    with tempfile.TemporaryDirectory() as folder:
        if arguments.tests:
            runs += [(model, EVENT[0]) for model in dict.fromkeys(models_in_tests(Path(folder)))]
        runs = [run for run in runs if arguments.only in run[0]]

        def both(run):
            old = result_of(arguments.old, *run, arguments.seconds)
            return run, old, old and result_of(arguments.new, *run, 2.0 * arguments.seconds)

        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            results = list(pool.map(both, runs))
    differing = skipped = refused = 0
    for (model, options), old, new in results:
        skipped += old is None
        refused += old is not None and "exit" in old
        found = old and (difference(old, new) if new else "took too long")
        if found:
            differing += 1
            print(f"{Path(model).name} {' '.join(options)}\n  {found}")
    print(f"{len(results)} runs: {differing} differ; {refused} refused by both, {skipped} too long to be compared")
    return 1 if differing or not results else 0


if __name__ == "__main__":
    sys.exit(main())

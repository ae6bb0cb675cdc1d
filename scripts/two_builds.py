"""Runs two builds of the tool on the same models: what same_bits.py and same_events.py have in common."""

import argparse
import concurrent.futures
import hashlib
import json
import re
import subprocess
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
    """A result without what differs from call to call."""
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


def arguments_of(description):
    """The command line that both scripts have."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--only", default="", help="models with this in their name")
    parser.add_argument("--engine", choices=("event", "fesd"), help="one engine only")
    parser.add_argument("--seconds", type=float, default=20.0, help="longest run; what takes longer is not compared")
    parser.add_argument("--tests", action="store_true", help="models in the sources of tests/, too")
    return parser.parse_args()


def runs_of(arguments, folder):
    """Pairs of a model and options: the catalogue by every way, models of the tests by the default integrator."""
    listed = subprocess.run([arguments.old, "models"], capture_output=True, text=True, check=True).stdout
    listed = listed.partition("\n\n")[0]
    ways = {"event": EVENT, "fesd": FESD}.get(arguments.engine, EVENT + FESD)
    runs = [(line.split()[0], options) for line in listed.splitlines() if line.strip() for options in ways]
    if arguments.tests:
        runs += [(model, EVENT[0]) for model in dict.fromkeys(models_in_tests(Path(folder)))]
    return [run for run in runs if arguments.only in run[0]]


def compare(arguments, difference):
    """Runs both builds and prints what differs; returns the exit code, 1 if anything differs or nothing ran.

    difference(run, old, new) is a text, or None where two results are taken for the same; run is a model and its options.
    """
    def compared(run):
        old = result_of(arguments.old, *run, arguments.seconds)
        if old is None:
            return run, "too long", None
        new = result_of(arguments.new, *run, 2.0 * arguments.seconds)
        found = difference(run, old, new) if new else "took too long"
        return run, "refused" if "exit" in old else "ran", found

    with tempfile.TemporaryDirectory() as folder:
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            results = list(pool.map(compared, runs_of(arguments, folder)))
    for (model, options), _, found in results:
        if found:
            print(f"{Path(model).name} {' '.join(options)}\n  {found}")
    differing = sum(found is not None for _, _, found in results)
    refused, skipped = (sum(fate == wanted for _, fate, _ in results) for wanted in ("refused", "too long"))
    print(f"{len(results)} runs: {differing} differ; {refused} refused by both, {skipped} too long to be compared")
    return 1 if differing or not results else 0

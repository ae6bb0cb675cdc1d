"""The monoped over 3 m in 30 intervals: a short way is solved, and five of it are the start.

python3 benchmarks/monoped/chain.py SALTUS [--by slide|hop] [--form step|stewart] [--finer 40 50 …] [--tracked 60 90 …]
    [--points 4 6] [--keep FOLDER] [--stages KEY=VALUE,… …]

slide: 0.25 m in 6 intervals (0.6 s) with two stages, then three, then the goal moved on to 0.4 m.
hop: 0.25 m with three stages at once, with a cost of a foot that moves near the ground, from a guess that lifts it.
The stages of the long problem are those of run.py; each begins at the result of the one before, cut where intervals end, so that
no element has length zero.
--finer: other intervals begin at that result, cut where theirs end, each with the settings of FINER.
--tracked: likewise with the stages of --points (each begins at the result of the one before), planned with less friction than the
simulated robot has, and a feedback that tracks the plan.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
BRANCH = {"optimize.stages": 3, "optimize.mpcc.first": "branch", "optimize.mpcc.sigma_initial": 0.001}
LIFTED = """[optimize.initial_guess]
x = "0.25*t/0.6"
z = "0.05*exp(-((t - 0.3)/0.15)^2)"
a = 0
b = 0
vx = 0.4
vz = 0
wa = 0
wb = 0
"""
GUESSES = {"slide": "", "hop": LIFTED}
WAYS = {
    "slide": [{}, {"optimize.stages": 3, "optimize.mpcc.sigma_initial": 0.01}, {**BRANCH, "way": 0.3},
              {**BRANCH, "way": 0.4}],
    "hop": [{"optimize.stages": 3, "clear": 5}],
}
STAGES = {"slide": ["points=3,first=branch,sigma=0.001"],
          "hop": ["goal=1.25,points=3,first=branch,sigma=0.001,clear=5"]}
FINER = "points=3,first=branch,sigma=0.001,clear=5,optimize.step_bounds=0.97"
TRACKED = ",friction=0.7,optimize.plant.mu=0.8,optimize.feedback=tracking"


def way(arguments, folder):
    """The result of the short way."""
    kind, before = arguments.by, None
    common = {"optimize.native": "on", "optimize.control_intervals": 6,
              "optimize.reformulation": arguments.form}
    model = folder / "way.toml"
    text = (HERE / "by_foot.toml").read_text(encoding="utf-8")
    model.write_text(text.replace("[optimize.mpcc]", GUESSES[kind] + "[optimize.mpcc]"), encoding="utf-8")
    for number, settings in enumerate(WAYS[kind]):
        out = folder / f"{kind}-{number}.json"
        words = [word for key, value in {**common, **settings}.items() for word in ("--set", f"{key}={value}")]
        start = ["--start", before] if before else []
        subprocess.run([arguments.saltus, "optimize", model, "--quiet", "--out", out,
                        "--time-limit", arguments.seconds, *start, *words], check=False)
        before = out
    return before


def run(arguments, folder, intervals, start, *stages):
    subprocess.run([sys.executable, HERE / "run.py", arguments.saltus, "--positions", "foot", "--intervals", str(intervals),
                    "--start", start, "--keep", folder, "--seconds", arguments.seconds, "--stages", *stages], check=True)
    return folder / f"{intervals}-{len(stages) - 1}.json"


def cut(result, out, intervals):
    subprocess.run([sys.executable, HERE / "hops.py", result, "--out", out, "--intervals", str(intervals)], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("saltus")
    parser.add_argument("--by", choices=list(WAYS), default="slide")
    parser.add_argument("--form", choices=["step", "stewart"], default="step")
    parser.add_argument("--finer", type=int, nargs="+", default=[])
    parser.add_argument("--tracked", type=int, nargs="+", default=[])
    parser.add_argument("--points", type=int, nargs="+", default=[4])
    parser.add_argument("--seconds", default="400", help="of every problem")
    parser.add_argument("--keep", help="folder for models and results")
    parser.add_argument("--stages", nargs="+")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="monoped-") as scratch:
        folder = pathlib.Path(arguments.keep or scratch)
        folder.mkdir(parents=True, exist_ok=True)
        short, start = way(arguments, folder), folder / "start.json"
        subprocess.run([sys.executable, HERE / "hops.py", *[short] * 5, "--out", start], check=True)
        first, *others = arguments.stages or STAGES[arguments.by]
        long = run(arguments, folder, 30, start, f"form={arguments.form},{first}", *others)
        if arguments.by == "hop" and not arguments.stages:
            cut(long, start, 30)
            long = run(arguments, folder, 30, start, f"form={arguments.form},{FINER}")
        for intervals in arguments.finer:
            cut(long, start, intervals)
            run(arguments, folder, intervals, start, FINER)
        for intervals in arguments.tracked:
            before = long
            for points in arguments.points:
                cut(before, start, intervals)
                subprocess.run([sys.executable, HERE / "hops.py", start, "--out", start, "--points", str(points)], check=True)
                settings = FINER.replace("points=3", f"points={points}") + TRACKED
                before = run(arguments, folder / f"tracked-{points}", intervals, start, settings)


if __name__ == "__main__":
    main()

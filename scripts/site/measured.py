"""Pages of what was measured: benchmarks/results as it is, each with its machine, date and a picture drawn from its numbers.

A file of benchmarks/results that names no date or no machine stops the build.
"""

import csv
import re
from collections import defaultdict
from statistics import median

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402

# name of the file: what it answers
FILES = {
    "compare": "How long does a run take, at equal error, beside code by hand, CVODE, SciPy, Siconos?",
    "events": "What does an event cost, in steps of its own run?",
    "fesd": "What does a step of finite elements cost, beside nosnoc?",
    "optimal_control": "How long does an optimisation take, beside nosnoc and a plain homotopy?",
    "contacts": "Which problems of optimal control with contacts are solved?",
    "monoped": "How far does the one-legged robot get?",
    "mpcc": "How many MPCCs of other programs are solved, beside a plain homotopy and mpecss?",
    "crisp": "What are contact-implicit problems on Euler grids worth, and how long do they take?",
    "soft-walls": "What does a control between soft walls cost, beside ADMM and branch and bound?",
    "mpc": "What does a closed loop cost, beside a warm-started homotopy?",
    "creep": "Do bodies at rest stay at rest, beside MuJoCo and Drake?",
    "contact-precision": "How large are errors of bodies that hit the ground, beside MuJoCo and SciPy?",
    "gradients": "Are derivatives through switches right, beside diffrax?",
    "random_optima": "How many random problems of optimal control come to the best that is known?",
    "large": "How do time and memory grow with the number of states?",
    "sweeps": "How many runs a second do several workers compute, beside SciPy in joblib?",
}
NARROW = ("compare", "events", "fesd", "optimal_control", "large", "crisp", "soft-walls", "mpc", "creep", "contact-precision", "gradients")  # tables of numbers, without sentences in their cells
DATE = re.compile(r"\b20\d\d-\d\d-\d\d\b")
COLOURS = ["#1b9e77", "#66c2a5", "#d95f02", "#7570b3", "#e7298a", "#a6761d"]


def read(root, name):
    with open(root / f"benchmarks/results/{name}.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def save(figure, path):
    figure.savefig(path, metadata={"Date": None})
    pyplot.close(figure)


def draw_compare(root, path):
    """Time over achieved error, a panel for each problem."""
    shown = [("Saltus", "dop853", "native"), ("Saltus", "taylor", "native"), ("by hand", "dop853", "relevant"),
             ("CVODE", "adams", "relevant"), ("SciPy", "dop853", "relevant")]
    points = defaultdict(lambda: defaultdict(list))
    for row in read(root, "compare"):
        if row["status"] == "completed" and row["found"] == row["expected"] and row["error"]:
            key = row["problem"], (row["contender"], row["method"], row["variant"])
            points[key][float(row["tolerance"])].append((float(row["error"]), float(row["seconds"])))
    problems = ["irma", "stick-slip", "relay-feedback", "gene-ring"]
    figure, axes = pyplot.subplots(2, 2, figsize=(7, 5.4), layout="constrained")
    for axis, problem in zip(axes.flat, problems):
        for colour, who in zip(COLOURS, shown):
            at = [(median(e for e, _ in row), median(s for _, s in row)) for _, row in sorted(points[problem, who].items())]
            at = [(max(error, 1e-16), 1e3 * seconds) for error, seconds in at]
            axis.loglog(*zip(*at), ".-", color=colour, label=" ".join(who[:2]), linewidth=1)
        axis.set_title(problem, fontsize=9, color="#808080")
        axis.invert_xaxis()
    figure.supxlabel("error", fontsize=9, color="#808080")
    figure.supylabel("ms", fontsize=9, color="#808080")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), fontsize=7, loc="outside upper center", ncols=len(shown))
    save(figure, path)


def bars(rows, who_of, value_of, path, unit):
    """A group of bars for each problem, logarithmic."""
    groups = list(dict.fromkeys(group for group, *_ in rows))
    names = list(dict.fromkeys(who_of(row) for row in rows))
    figure, axis = pyplot.subplots(figsize=(7, 0.8 + 0.5 * len(groups)), layout="constrained")
    width = 0.8 / len(names)
    for i, name in enumerate(names):
        at = [(groups.index(row[0]) + (i - (len(names) - 1) / 2) * width, value_of(row)) for row in rows if who_of(row) == name]
        axis.barh(*zip(*at), height=width, color=COLOURS[2 * i % len(COLOURS)], label=name)
    axis.set_xscale("log")
    axis.set_yticks(range(len(groups)), groups)
    axis.invert_yaxis()
    axis.set_xlabel(unit)
    figure.legend(fontsize=7, loc="outside upper right", ncols=len(names))
    save(figure, path)


def draw_fesd(root, path):
    rows = [(f"{r['problem']}, {r['form']}, {r['scheme']}", r["contender"], 1e3 * float(r["seconds_per_step"]))
            for r in read(root, "fesd") if r["seconds_per_step"]]
    bars(rows, lambda row: row[1], lambda row: row[2], path, "ms for a step")


def draw_optimal_control(root, path):
    found = defaultdict(list)
    for r in read(root, "optimal_control"):
        if r["seconds"]:
            found[r["problem"], r["contender"]].append(float(r["seconds"]))
    bars([(*key, median(values)) for key, values in found.items()], lambda row: row[1], lambda row: row[2], path, "s")


def draw_large(root, path):
    """Time and memory over the number of states, from the table of the page."""
    text = (root / "benchmarks/results/large.md").read_text(encoding="utf-8")
    found = defaultdict(list)
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) != 11 or not cells[1].isdigit():
            continue
        kind, size, _, _, interpreted, _, native, _, _, memory, _ = cells
        found[kind].append((int(size), float(native or interpreted), int(memory)))
    if not found:
        raise SystemExit("benchmarks/results/large.md has no rows to draw")
    figure, axes = pyplot.subplots(1, 2, figsize=(7, 2.8), layout="constrained")
    for colour, (kind, rows) in zip(COLOURS, found.items()):
        sizes, seconds, memory = zip(*rows)
        axes[0].loglog(sizes, seconds, ".-", color=colour, label=kind)
        axes[1].loglog(sizes, memory, ".-", color=colour, label=kind)
    for axis, label in zip(axes, ("s", "MB")):
        axis.set_xlabel("N")
        axis.set_ylabel(label)
    axes[0].legend(fontsize=7)
    save(figure, path)


DRAWN = {"compare": (draw_compare, "Time over achieved error of five contenders on four problems"),
         "fesd": (draw_fesd, "Milliseconds for a step of Saltus and nosnoc"),
         "optimal_control": (draw_optimal_control, "Seconds of Saltus, a plain homotopy and nosnoc"),
         "large": (draw_large, "Seconds and megabytes over the number of states")}


SECONDS = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}


def shortest(text):
    """Of compare.md: for each problem and contender the method that needs the least time for an error of 1e-8."""
    found = defaultdict(dict)
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) != 12 or cells[3] in ("interpreted", "trajectory", "variant"):
            continue
        if told := re.fullmatch(r"\D*?([\d.e+]+) (ns|µs|ms|s)", cells[5]):
            seconds = float(told.group(1)) * SECONDS[told.group(2)]
            known = found[cells[0]].get(cells[1])
            if known is None or seconds < known[0]:
                found[cells[0]][cells[1]] = (seconds, f"{cells[5]} ({cells[2]})")
    contenders = list(dict.fromkeys(name for row in found.values() for name in row))
    rows = ["Time for an error of 1e-8, by the fastest method of each:", "", "| problem | " + " | ".join(contenders) + " |",
            "|---" * (len(contenders) + 1) + "|"]
    rows += [f"| {problem} | " + " | ".join(row.get(name, (0, "–"))[1] for name in contenders) + " |" for problem, row in found.items()]
    return "\n".join([*rows, "", "`<`: the loosest setting is more accurate already; `~`, `≈`: extrapolated; –: not reached."])


def first_table(text):
    return re.search(r"^\|.*?\n(?=\n|\Z)", text, re.MULTILINE | re.DOTALL).group().rstrip()


def unbroken(text):
    """Tables of numbers are not broken inside of their numbers."""
    return re.sub(r"(^\|.*?\n)(?=\n|\Z)", r":::{container} numbers\n\1:::\n", text.rstrip("\n") + "\n", flags=re.MULTILINE | re.DOTALL)


def mended(text):
    """Links of the source tree as links of the site, or as names."""
    text = text.replace("](../README.md", "](how.md").replace("](../../docs/", "](../../")
    shown = lambda link: f"[{link[1]}]({link[2]}.md)" if link[2] in FILES else f"`benchmarks/results/{link[2]}.md`"
    text = re.sub(r"\[([^]]*)\]\(results/([a-z_-]+)\.md\)", shown, text)
    return re.sub(r"!\[[^\]]*\]\([a-z_]+\.svg\)\n?", "", text)


def write(source, root):
    """The pages in source/made/measured; the table of them goes where benchmarks.md says `% measured`."""
    matplotlib.rc_file(root / "scripts/site/matplotlibrc")
    folder = source / "made/measured"
    folder.mkdir(parents=True, exist_ok=True)
    rows = ["| Question | measured |", "|---|---|"]
    pictures = []
    for name, question in FILES.items():
        text = (root / f"benchmarks/results/{name}.md").read_text(encoding="utf-8")
        date, machine = DATE.search(text), re.search(r"(?:AMD|Intel|Apple)[^,.]*(?:, \d+ processors)?", text)
        if not date or not machine:
            raise SystemExit(f"benchmarks/results/{name}.md names no date (YYYY-MM-DD) or no machine")
        heading, _, rest = text.partition("\n")
        picture = ""
        if name in DRAWN:
            draw, shown = DRAWN[name]
            draw(root, folder / f"{name}.svg")
            picture = f"\n![{shown}]({name}.svg)\n"
            pictures += [f"## {heading.lstrip('# ')}", "", f"{question} Measured {date.group()} on {machine.group()}; [all numbers](made/measured/{name}.md).", "",
                         f"![{shown}](made/measured/{name}.svg)", "", unbroken(shortest(text) if name == "compare" else first_table(text)), ""]
        (folder / f"{name}.md").write_text(f"{heading}\n\n{question}\n{picture}{unbroken(mended(rest)) if name in NARROW else mended(rest)}", encoding="utf-8")
        rows.append(f"| [{question}](made/measured/{name}.md) | {machine.group()}, {date.group()} |")
    how = mended((root / "benchmarks/README.md").read_text(encoding="utf-8")).replace("# Benchmarks", "# How it was measured", 1)
    (folder / "how.md").write_text(how, encoding="utf-8")
    page = source / "benchmarks.md"
    listed = "\n".join(["```{toctree}", ":hidden:", "", *(f"made/measured/{name}" for name in [*FILES, "how"]), "```"])
    page.write_text(page.read_text(encoding="utf-8").replace("% measured", "\n".join([*rows, "", *pictures, listed])), encoding="utf-8")

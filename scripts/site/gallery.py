"""Makes the gallery: a page for every shipped model with picture, equations and tags, and the index with its filter.

usage: gallery.py FOLDER
"""

import html
import os
import sys
import time
import tomllib
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib

matplotlib.use("svg")
from matplotlib import pyplot  # noqa: E402

import saltus  # noqa: E402

ROOT = Path(os.environ["SALTUS_SITE_ROOT"])
LIMIT = 20.0  # seconds for one optimisation; what needs more is shown as it is simulated


def tags_of(text, data, result):
    """What a model shows, from its file and from its run."""
    kinds = {event.kind for event in result.events}
    tags = []
    for tag, holds in (
        ("sliding", bool(kinds & {"enter_sliding", "change_sliding", "leave_sliding"}) or (result.mode == 0).any()),
        ("crossing", "crossing" in kinds),
        ("jumps", "jumps" in data),
        ("accumulation", "accumulation" in kinds),
        ("hysteresis", "hysteresis" in data),
        ("contacts", "contacts" in data),
        ("regions", "modes" in data),
        ("tables", "tables" in data),
        ("several surfaces", len(result.switching_functions) > 1),
        ("not unique", any(event.unique is False for event in result.events)),
        ("depends on time", any("t" in words(value) for value in expressions(data))),
        ("optimal control", "optimize" in data),
        ("closed form", "closed form" in text.lower() or "exact" in text.lower()),
    ):
        if holds:
            tags.append(tag)
    return tags


def expressions(data):
    for key in ("dynamics", "definitions", "switching"):
        yield from (str(value) for value in data.get(key, {}).values())


def words(expression):
    return "".join(c if c.isalnum() or c == "_" else " " for c in expression).split()


def equations(model):
    """The equations as lines of text."""
    return [f"{left} = {right}" + (f"   ({where})" if where else "") for left, right, where in model.equations()]


def run(name):
    model = saltus.catalogue(name)
    data = tomllib.loads(Path(model.path).read_text())
    begin = time.monotonic()
    if "optimize" in data:
        result = model.optimize(time_limit=LIMIT)
        if not result.status.done and "simulate" in data:
            result = model.simulate()
    else:
        result = model.simulate()
    return model, data, result, time.monotonic() - begin


def picture(result, path):
    names = [*result.states, *result.controls][:4]
    figure, axes = pyplot.subplots(len(names), 1, sharex=True, squeeze=False, figsize=(6.4, 0.8 + 1.1 * len(names)), layout="constrained")
    result.plot(names, axes=axes[:, 0])
    axes[0, 0].set_title("")
    figure.savefig(path, metadata={"Date": None})
    pyplot.close(figure)


def page(name, model, result, tags, seconds):
    text = Path(model.path).read_text()
    command = "optimize" if result.optimization else "simulate"
    rows = [f"# {name}", "", model.description.capitalize() + ".", "", f"![states of {name} over time]({name}.svg)", "",
            f"*{' · '.join(tags)}*", "", "```text", *equations(model), "```", "",
            f"`saltus {command} {name}` ends with `{result.status}` at t = {result.status.time_reached:.6g}, "
            f"{len(result.events)} events. It took {seconds:.2g} s here.", "", "## The file", "", "```toml", text.rstrip(), "```", ""]
    return "\n".join(rows)


def index(cards, counts):
    rows = ["# Gallery", "", "All shipped models: `saltus models`. Each picture is made when this page is built. What each is good for: "
            "[the catalogue](../catalogue.md).", "", "<div class='filter' role='group' aria-label='Show models with'>",
            "<button type='button' data-tag='' aria-pressed='true'>all</button>"]
    rows += [f"<button type='button' data-tag='{tag}' aria-pressed='false'>{tag} ({count})</button>" for tag, count in counts]
    rows += ["</div>", "", "<div class='cards'>"]
    for name, description, tags in cards:
        rows.append(f"<a class='card' href='{name}.html' data-tags='{'|'.join(tags)}'><img src='../_images/{name}.svg' alt='' loading='lazy'/>"
                    f"<b>{name}</b><span>{html.escape(description)}</span></a>")
    rows += ["</div>", "", "<script src='../_static/gallery.js'></script>", "", "```{toctree}", ":hidden:", ""]
    return "\n".join(rows + [name for name, _, _ in cards] + ["```", ""])


def main(folder):
    folder.mkdir(parents=True, exist_ok=True)
    warnings.simplefilter("ignore")
    names = saltus.models()
    cards, counts = [], {}
    with ThreadPoolExecutor(2) as pool:
        for name, (model, data, result, seconds) in zip(names, pool.map(run, names)):
            picture(result, folder / f"{name}.svg")
            tags = tags_of(Path(model.path).read_text(), data, result)
            (folder / f"{name}.md").write_text(page(name, model, result, tags, seconds))
            cards.append((name, model.description, tags))
            for tag in tags:
                counts[tag] = counts.get(tag, 0) + 1
    (folder / "index.md").write_text(index(cards, sorted(counts.items())))
    print(f"gallery: {len(cards)} models")


if __name__ == "__main__":
    main(Path(sys.argv[1]))

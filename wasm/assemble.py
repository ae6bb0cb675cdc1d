"""Puts engine, page and examples into one HTML file that works offline, also from a disk.

usage: assemble.py ENGINE.js PLOTLY.js OUTPUT.html
"""

import json
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
# One of each kind, in the order of the list; what needs another method or other files is not among them.
EXAMPLES = ["stick-slip", "bouncing-ball", "thermostat", "relay-oscillator", "sliding-mode-pendulum", "buck-converter", "two-genes", "falling-rod", "hopper"]


def inside_script(text):
    """Text in a script element of another type ends where the element does, and nowhere before."""
    return text.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def models():
    files = [HERE.parent / "models" / f"{name}.toml" for name in EXAMPLES]
    return json.dumps([{"name": file.stem, "text": file.read_text(encoding="utf-8")} for file in files]).replace("<", "\\u003c")


def main(engine, plotly, output):
    page = HERE / "page"
    parts = {
        "STYLE": (page / "try.css").read_text(encoding="utf-8"),
        "MODELS": models(),
        "PLOTLY": inside_script(Path(plotly).read_text(encoding="utf-8")),
        "ENGINE": inside_script(Path(engine).read_text(encoding="utf-8")),
        "WORKER": inside_script((page / "worker.js").read_text(encoding="utf-8")),
        "SCRIPT": (page / "try.js").read_text(encoding="utf-8").replace("</script", "<\\/script"),
    }
    text = (page / "try.html").read_text(encoding="utf-8")
    for name, content in parts.items():
        before, after = text.split(f"@{name}@")
        text = before + content + after
    Path(output).write_text(text, encoding="utf-8")
    print(f"{output}: {len(text.encode()) / 1e6:.1f} MB")


if __name__ == "__main__":
    main(*sys.argv[1:])

"""Draws docs/figures/walking-box.gif: simulates examples/contacts/walking-box.toml by `saltus` and paints what the result says is drawn.

usage: walking_box.py TOOL [FILE.gif]      needs Pillow

Upper part: the shapes of `drawing` in the result file. Lower part: what each foot does (`contact_modes`), over time. Half speed.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parents[2]
MODEL = ROOT / "examples/contacts/walking-box.toml"
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
WIDTH, HEIGHT, GROUND, SCALE, LEFT = 720, 264, 160, 400, 0.4  # pixels; pixels per metre; metres left of the origin
STRIP, ROW, BEGIN = 186, 22, 84  # where the strips of the feet lie
INK, PAPER = "#1f2933", "#ffffff"
COLOURS = {"stick": "#2f6f9f", "slip": "#e08a2e", "open": "#d5dbe1"}
MILLISECONDS = 40  # of a frame; a frame is 0.02 s of the model


def simulate(tool):
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "result.json"
        subprocess.run([tool, "simulate", MODEL, "--quiet", "--out", out], check=True)
        return json.loads(out.read_text(encoding="utf-8"))


def rows_at_frames(times, step):
    """Index of the last row at every multiple of the step: events have rows of their own."""
    frames, at = [], 0.0
    for i, t in enumerate(times):
        if i + 1 == len(times) or times[i + 1] > at + 1e-9:
            if t >= at - 1e-9:
                frames.append(i)
                at += step
    return frames


def pixel(x, z):
    return (LEFT + x) * SCALE, GROUND - z * SCALE


def paint_shapes(draw, shapes, values):
    """Values of a row: x, z of every point; of a disc also its radius."""
    place = 0
    for shape in shapes:
        count = shape["points"]
        points = [pixel(*values[place + 2 * k:place + 2 * k + 2]) for k in range(count)]
        place += 2 * count
        if shape["kind"] == "disc":
            (x, z), radius = points[0], values[place] * SCALE
            place += 1
            draw.ellipse((x - radius, z - radius, x + radius, z + radius), fill=COLOURS["slip"], outline=INK, width=2)
        else:
            draw.line(points, fill=INK, width=3, joint="curve")


def paint_modes(draw, font, result, last):
    times, modes = result["trajectory"]["t"], result["trajectory"]["contact_modes"]
    per_second = (WIDTH - BEGIN - 16) / times[-1]
    for foot, name in enumerate(result["contacts"]):
        top = STRIP + foot * (ROW + 4)
        draw.text((12, top + 2), name, fill=INK, font=font)
        for i in range(last):
            ends = BEGIN + times[i] * per_second, BEGIN + times[i + 1] * per_second
            if ends[1] > ends[0]:
                draw.rectangle((ends[0], top, ends[1], top + ROW), fill=COLOURS[modes[i][foot]])
    left = BEGIN
    for name, says in (("stick", "sticks"), ("slip", "slips"), ("open", "off the ground")):
        draw.rectangle((left, HEIGHT - 20, left + 12, HEIGHT - 8), fill=COLOURS[name])
        draw.text((left + 18, HEIGHT - 22), says, fill=INK, font=font)
        left += 100
    draw.text((WIDTH - 220, HEIGHT - 22), f"t = {times[last]:.2f} s, half speed", fill=INK, font=font)


def main(tool, file):
    result = simulate(tool)
    font = ImageFont.truetype(FONT, 14)
    frames = []
    for last in rows_at_frames(result["trajectory"]["t"], 0.02):
        image = Image.new("RGB", (WIDTH, HEIGHT), PAPER)
        draw = ImageDraw.Draw(image)
        paint_shapes(draw, result["drawing"]["shapes"], result["drawing"]["rows"][last])
        paint_modes(draw, font, result, last)
        frames.append(image.quantize(32, dither=Image.Dither.NONE))
    frames[0].save(file, save_all=True, append_images=frames[1:], duration=MILLISECONDS, loop=0, optimize=True)
    print(f"{file}: {len(frames)} frames, {Path(file).stat().st_size} bytes")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else ROOT / "docs/figures/walking-box.gif")

"""Frames of the robot in one picture, from the drawing of a stored result.

python3 benchmarks/monoped/frames.py RESULT.json --out FRAMES.svg [--every 0.05]
"""

import argparse
import bisect
import json
import pathlib

SCALE, LEFT, TOP, BOTTOM = 300, -0.3, 0.75, -0.08  # pixels per metre; metres


def point(x, z):
    return f"{SCALE * (x - LEFT):.1f},{SCALE * (TOP - z):.1f}"


def frames(result, every):
    """Points of the leg, hip first, at equal distances of time."""
    times, rows = result["trajectory"]["t"], result["drawing"]["rows"]
    for k in range(round(result["horizon"] / every) + 1):
        i = min(bisect.bisect_left(times, k * every - 1e-9), len(rows) - 1)
        yield k * every / result["horizon"], [(rows[i][2 * j], rows[i][2 * j + 1]) for j in range(3)]


def path(result):
    rows = result["drawing"]["rows"]
    return " ".join(point(row[0], row[1]) for row in rows), " ".join(point(row[4], row[5]) for row in rows)


def picture(result, every):
    right = max(row[0] for row in result["drawing"]["rows"]) + 0.3
    width, height = SCALE * (right - LEFT), SCALE * (TOP - BOTTOM)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}">',
             '<rect width="100%" height="100%" fill="white"/>',
             f'<polyline points="{point(LEFT, 0)} {point(right, 0)}" stroke="#444" stroke-width="2"/>']
    hip, foot = path(result)
    for points, colour in ((hip, "#c50"), (foot, "#07a")):
        lines.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1"/>')
    for part, leg in frames(result, every):
        colour = f"hsl({240 - 200 * part:.0f},60%,45%)"
        points = " ".join(point(*place) for place in leg)
        x, z = point(*leg[0]).split(",")
        lines.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>'
                     f'<circle cx="{x}" cy="{z}" r="6" fill="{colour}"/>')
    return "\n".join([*lines, "</svg>"]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result")
    parser.add_argument("--out", required=True)
    parser.add_argument("--every", type=float, default=0.05)
    arguments = parser.parse_args()
    result = json.loads(pathlib.Path(arguments.result).read_text(encoding="utf-8"))
    pathlib.Path(arguments.out).write_text(picture(result, arguments.every), encoding="utf-8")


if __name__ == "__main__":
    main()

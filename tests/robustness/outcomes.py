"""Compares what comes of random systems with what came of them, seed by seed.

usage: outcomes.py [--program saltus_random_campaign] [--families affine contacts …] [--count N] [--jobs 2] [--record]

Reads outcomes/FAMILY.csv.gz beside this script, draws the same seeds anew and lists those that differ, by what differs:
  status   of the run: completed, outside_class, …
  events   their number, kinds, names or surfaces
  times    of the events, as a sum, by more than the tolerance
  end      the sum of i x_i of the end state, by more than the tolerance
Families are those of saltus_random_campaign, and contacts (random_contacts.py, which needs the package: PYTHONPATH). --count
takes the first N seeds of each only. --record writes the files instead, with --count seeds from --first on; a change that
means to change outcomes records them in a commit of its own, and says why. The columns, with numbers to 7 digits, are
those of outcomes.hpp: --outcomes of both programs prints them with the whole end state, for two builds to be compared by
diff. Exit code 1 if anything differs.
"""

import argparse
import collections
import concurrent.futures
import csv
import datetime
import gzip
import io
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
FAMILIES = ("affine", "constant", "smooth", "nested", "friction", "jumps", "relays", "regions", "contacts")
COLUMNS = ("status", "events", "hash", "times", "end")  # that are recorded; seeds follow each other
AT_ONCE = 100


def rounded(value):
    """A number as outcomes.cpp writes it: 7 significant digits, below 1 seven decimals."""
    if not abs(value) < 1:
        return f"{value:.7g}"
    return f"{round(value * 1e7) / 1e7 + 0.0:.7g}"


def hash_of(texts):
    """FNV-1a of texts and their ends, folded to 16 bits."""
    value = 2166136261
    for byte in b"".join(text.encode() + b"\0" for text in texts):
        value = (value ^ byte) * 16777619 & 0xFFFFFFFF
    return (value >> 16) ^ (value & 0xFFFF)


def line_of(seed, status, events, x):
    """A line of outcomes.hpp; events have t, kind, name and surfaces."""
    kinds = collections.Counter(event.kind for event in events)
    texts = [text for event in events for text in (event.kind, event.name or "", *event.surfaces)]
    end = sum((i + 1) * value for i, value in enumerate(x))
    return ",".join([str(seed), status, str(len(events)), ";".join(f"{kind}:{n}" for kind, n in kinds.items()),
                     f"{hash_of(texts):04x}", rounded(sum(event.t for event in events)), rounded(end),
                     ";".join(map(rounded, x))])


def command_of(program, family, first, count):
    if family == "contacts":
        return [sys.executable, HERE / "random_contacts.py", "--outcomes", "--first", str(first), "--runs", str(count)]
    return [program, "--outcomes", family, str(first), str(count)]


def computed(arguments, family, first, count):
    """Rows of the recorded columns, by seed."""
    def part(begin):
        command = command_of(arguments.program, family, begin, min(AT_ONCE, first + count - begin))
        text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        return [tuple(row[column] for column in COLUMNS) for row in csv.DictReader(io.StringIO(text))]

    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        return [row for rows in pool.map(part, range(first, first + count, AT_ONCE)) for row in rows]


def record(file, family, first, rows):
    """Writes rows compressed; the same rows make the same bytes on one day."""
    head = f"# {family}: seeds {first} to {first + len(rows) - 1}, recorded {datetime.date.today().isoformat()}"
    text = "\n".join([head, ",".join(COLUMNS), *(",".join(row) for row in rows), ""])
    file.parent.mkdir(exist_ok=True)
    file.write_bytes(gzip.compress(text.encode(), compresslevel=9, mtime=0))


def recorded(file):
    """The first seed and the rows of a file."""
    head, _, *lines = gzip.decompress(file.read_bytes()).decode().splitlines()
    return int(head.split("seeds ")[1].split()[0]), [tuple(line.split(",")) for line in lines]


def differs(old, new, tolerance):
    """What differs first between two rows, or None."""
    if old[0] != new[0]:
        return "status"
    if old[1:3] != new[1:3]:
        return "events"
    for place, what in ((3, "times"), (4, "end")):
        one, other = float(old[place]), float(new[place])
        if old[place] != new[place] and not abs(one - other) <= tolerance * max(1.0, abs(one)):
            return what
    return None


def compare(family, first, old, new, tolerance):
    """Prints the seeds of a family that differ; returns how many do."""
    found = collections.defaultdict(list)
    for seed, (one, other) in enumerate(zip(old, new, strict=True), start=first):
        if what := differs(one, other, tolerance):
            found[what].append((seed, one, other))
    count = sum(map(len, found.values()))
    print(f"{family}: {len(old)} seeds, {count} differ", flush=True)
    for what, seeds in found.items():
        print(f"  {what}: {len(seeds)} seeds: {' '.join(str(seed) for seed, _, _ in seeds)}")
        for seed, one, other in seeds[:10]:
            print(f"    {seed}: {' '.join(one)} became {' '.join(other)}")
    return count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/tests/robustness/saltus_random_campaign")
    parser.add_argument("--families", nargs="*", choices=FAMILIES, default=FAMILIES)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--count", type=int)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--tolerance", type=float, default=1e-6, help="of sums, relative to the larger of them and 1")
    parser.add_argument("--record", action="store_true")
    arguments = parser.parse_args()
    differing = 0
    for family in arguments.families:
        file = HERE / "outcomes" / f"{family}.csv.gz"
        if arguments.record:
            rows = computed(arguments, family, arguments.first, arguments.count or 1000)
            record(file, family, arguments.first, rows)
            print(f"{family}: {len(rows)} seeds, {file.stat().st_size} bytes", flush=True)
            continue
        first, old = recorded(file)
        old = old[:arguments.count]
        differing += compare(family, first, old, computed(arguments, family, first, len(old)), arguments.tolerance)
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())

"""Prints how long the sources of each module took to compile, from the logs of Ninja; nothing is judged.

usage: compile_seconds.py SOURCE_FOLDER

Seconds are those from the start to the end of the compiler, so that what else ran at that time counts; objects from a compiler cache
take none. What was built twice counts as it was built last.
"""

import re
import sys
from pathlib import Path

LIBRARY = re.compile(r"^CMakeFiles/saltus_(\w+)\.dir/.*\.o$")
OBJECT = re.compile(r"\.o$")


def seconds_of_objects(log):
    """Object -> seconds."""
    seconds = {}
    for line in log.splitlines():
        fields = line.split("\t")
        if len(fields) >= 4 and OBJECT.search(fields[3]):
            seconds[fields[3]] = (int(fields[1]) - int(fields[0])) / 1000.0
    return seconds


def seconds_of_modules(log):
    """Module, or the folder of programs -> (objects, seconds, the longest of them); the longest first."""
    sums = {}
    for name, seconds in seconds_of_objects(log).items():
        library = LIBRARY.match(name)
        module = library.group(1) if library else name.partition("CMakeFiles")[0].rstrip("/")
        count, total, longest = sums.get(module, (0, 0.0, 0.0))
        sums[module] = count + 1, total + seconds, max(longest, seconds)
    return dict(sorted(sums.items(), key=lambda item: -item[1][1]))


def main(root):
    for log in sorted(root.glob("build/*/.ninja_log")):
        modules = seconds_of_modules(log.read_text(encoding="utf-8", errors="replace"))
        print(f"{log.parent.relative_to(root)}: {sum(entry[1] for entry in modules.values()):.0f} s in the compiler")
        for module, (count, total, longest) in modules.items():
            print(f"  {total:7.1f} s  {count:4d} objects  longest {longest:6.1f} s  {module}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))

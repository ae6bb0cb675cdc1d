"""Complains about files in Git that a build or a run left behind: logs, outputs of the tool at the root of the tree.

usage: stray_logs.py [FILE...]      without files: all that Git knows
"""

import re
import subprocess
import sys

STRAY = re.compile(r"(^|/)[^/]*\.log$|(^|/)(nohup\.out|core|ctest\.xml|callgrind\.out\.\d+)$|^[^/]+\.(json|csv|html|npz|svg)$|(^|/)[^/]+\.(o|so|orig|rej)$")
MEANT = {"CMakePresets.json"}


def main(files):
    if not files:
        files = subprocess.run(["git", "ls-files", "-z"], check=True, capture_output=True, text=True).stdout.split("\0")
    stray = [name for name in files if STRAY.search(name) and name not in MEANT]
    for name in stray:
        print(f"{name}: left behind by a build or a run; git rm --cached it")
    return 1 if stray else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

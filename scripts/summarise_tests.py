"""Adds up CTest's JUnit reports: a line per preset, the failed tests by name with the end of what they printed, and "N passed,
M failed" as the last line.

usage: summarise_tests.py PRESET=REPORT.xml ...

A missing or empty report is a failure of its own (the build broke, or no test was found), so that nothing can pass by
not running. Exit code 1 if anything failed.
"""

import sys
import xml.etree.ElementTree as xml
from pathlib import Path


def outcome(case):
    """passed | failed | skipped of one <testcase>."""
    if case.find("failure") is not None or case.find("error") is not None or case.get("status") == "fail":
        return "failed"
    if case.find("skipped") is not None or case.get("status") in ("notrun", "disabled"):
        return "skipped"
    return "passed"


def last_lines(case, count=30):
    """The last lines that a test printed. The log of a whole run is long; who has only its end needs these."""
    return (case.findtext("system-out") or "").rstrip().splitlines()[-count:]


def read(report):
    """Name, outcome and last lines of every test of a report; None if there is no readable report."""
    try:
        cases = xml.parse(report).getroot().iter("testcase")
        return [(case.get("name"), outcome(case), last_lines(case)) for case in cases]
    except (OSError, xml.ParseError):
        return None


def main(arguments):
    totals = {"passed": 0, "failed": 0, "skipped": 0}
    lines = []
    for argument in arguments:
        preset, _, report = argument.partition("=")
        tests = read(Path(report))
        if not tests:
            totals["failed"] += 1
            lines.append(f"{preset}: did not build, or ran no test")
            continue
        counts = {kind: sum(1 for _, got, _ in tests if got == kind) for kind in totals}
        for kind, count in counts.items():
            totals[kind] += count
        lines.append(f"{preset}: {counts['passed']} passed, {counts['failed']} failed, {counts['skipped']} skipped")
        for name, got, printed in tests:
            if got == "failed":
                lines += [f"  failed: {name}", *(f"    | {line}" for line in printed)]
    print("\n" + "\n".join(lines))
    if totals["skipped"]:
        print(f"{totals['skipped']} skipped")
    print(f"{totals['passed']} passed, {totals['failed']} failed")
    return 1 if totals["failed"] else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

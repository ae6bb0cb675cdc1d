"""Compares the results of two builds of the tool, bit for bit.

usage: same_bits.py OLD NEW [--only WORD] [--engine event|fesd] [--seconds S] [--tests]

Runs all models of the catalogue with every integrator of the event engine and in both forms of FESD. With --tests, models
that stand as text in the sources of tests/ are run, too, with the default integrator. Times, versions and the place of the
tool are left out of the comparison. Prints what differs; exit code 1 if anything does.
"""

import sys

import two_builds


def difference(old, new, place=""):
    """Where two results differ first, or None."""
    if isinstance(old, dict) and isinstance(new, dict) and old.keys() == new.keys():
        pairs = [(f"{place}.{key}", old[key], new[key]) for key in old]
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        pairs = [(f"{place}[{number}]", *pair) for number, pair in enumerate(zip(old, new))]
    else:
        # repr: 0 and -0 differ, NaN is NaN
        return None if repr(old) == repr(new) else f"{place}: {str(old)[:150]} became {str(new)[:150]}"
    return next((found for pair in pairs if (found := difference(pair[1], pair[2], pair[0]))), None)


if __name__ == "__main__":
    sys.exit(two_builds.compare(two_builds.arguments_of(__doc__), lambda _, old, new: difference(old, new)))

"""Ratchet of what an engine does in several places and should do in one: each mechanism with the places that do it.

A place is a file, or a call in it. What a mechanism is made of is told by patterns over the code without comments; the less
of them there are, the fewer answers one question has.
"""

import re

from sources import code_of, cpp_files

ROOMS_WITHOUT_SEARCH = ("field", "decide", "mode", "instant", "sequences", "approach", "contact", "jumps")
# Mechanism -> (folders, pattern): each line that matches is a place.
CALLS = {
    # Where the field of a mode begins at a point: behind a decision, and behind an ordinary switch.
    "modes begin": (("event_integrator",), re.compile(r"(?<!bool )\bbegin_field\(")),
    # Where the search is set up for a mode: with that, and once more when the signs of user functions are known.
    "searches begin": (("event_integrator",), re.compile(r"\bsearch_?\.(?:begin|enter)\(")),
    # Where a state is put onto what is held at zero.
    "states are projected": (("event_integrator",), re.compile(r"^bool \w+::project\([^;]*\bx\b")),
}
# Mechanism -> (folders, pattern): each file with a match is a place.
FILES = {
    # Which value of a function counts as zero, beside the search, which has levels of its own.
    "zero is told from rounding": (
        tuple(f"event_integrator/{room}" for room in ROOMS_WITHOUT_SEARCH),
        re.compile(r"\brounding_of\("),
    ),
}
DEFINES_ZERO = "src/saltus/event_integrator/mode/resolution.hpp"
# Files that look for faces of 0 in w + W z + N_Z(z): enumerations, pivots and sweeps of their own, until they use one solver. Not among
# them, as their own top comments say: decide/transition_large.cpp (g(alpha) has products, n is large: sparse Newton steps under a
# certificate) and decide/sets/find_resting_surfaces.cpp (no z to find: what is kept at zero, and which end of a selection presses most).
# Left is jumps/holding.cpp: its w = L_f^2 g is at hand, W is in the kernel only, and only for guards that it holds.
COMPLEMENTARITY = "complementarity is solved"
SOLVERS = (
    "event_integrator/contact/contact_forces.cpp",
    "event_integrator/contact/impact.cpp",
    "event_integrator/jumps/holding.cpp",
    "fesd_integrator/decide/transition_regions.cpp",
    "switching/regions/region_decision.cpp",
    "switching/regions/tied_regions.cpp",
    "switching/selections/selection_complementarity.cpp",
)
ONE_SOLVER = '#include "saltus/switching/point/'


def find_mechanisms(root, _table):
    """(mechanism, place)."""
    for mechanism, (folders, pattern) in CALLS.items():
        for path, lines in code_in(root, folders):
            for number, line in enumerate(lines, 1):
                if pattern.search(line):
                    yield mechanism, f"{path}:{number}"
    for mechanism, (folders, pattern) in FILES.items():
        for path, lines in code_in(root, folders):
            if path != DEFINES_ZERO and any(pattern.search(line) for line in lines):
                yield mechanism, path
    for solver in SOLVERS:
        path = root / "src" / "saltus" / solver
        parts = [part for part in (path, path.with_suffix(".hpp")) if part.exists()]
        if path.exists() and not any(ONE_SOLVER in part.read_text(encoding="utf-8") for part in parts):
            yield COMPLEMENTARITY, f"src/saltus/{solver}"


def code_in(root, folders):
    """(path, lines of code) of the sources and headers in folders of src/saltus."""
    for path in cpp_files(root):
        name = str(path.relative_to(root))
        if any(name.startswith(f"src/saltus/{folder}/") for folder in folders):
            yield name, code_of(path).splitlines()

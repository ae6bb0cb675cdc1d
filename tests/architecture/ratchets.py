"""Ratchets: what is counted and may only become less. ceilings.toml has how much of it there is.

A ratchet finds things (key, item): the key is what has a ceiling, a module or a class, the item says which thing and where. A
ceiling is a number of items, or a list of them where each has to be named. More than the ceiling is a mistake; less is one, too:
the ceiling is to be lowered then, so that nothing comes back. lower_ceilings.py does that.
"""

from calls import find_call_cycles
from includes import find_forced_includes, find_reaches_casadi, find_reaches_eigen, find_rooms_of_others
from literals import find_numeric_literals
from mechanisms import find_mechanisms
from tested import find_untested_parts

CEILINGS = "tests/architecture/ceilings.toml"

# What each finds, and what a person does about one more of them.
RATCHETS = {
    "reaches_casadi": (find_reaches_casadi, "sources reach casadi/ through their includes: include a header without it"),
    "reaches_eigen": (find_reaches_eigen, "sources reach Eigen through their includes: it belongs into linalg and adapters"),
    "forced_includes": (find_forced_includes, "headers that the build includes and no source names: write the #include"),
    "rooms_of_others": (find_rooms_of_others, "headers from inside a room of another module: include its face, or widen that"),
    "call_cycles": (find_call_cycles, "member functions that call each other in a circle: pass on a value instead"),
    "mechanisms": (find_mechanisms, "places do what is one mechanism: use the one that there is"),
    "numeric_literals": (find_numeric_literals, "numbers inline: give each a name (constexpr), and say where it comes from"),
    "untested_parts": (find_untested_parts, "parts that no unit test of their module names: write one"),
}

# Where a ceiling is a list: the keys, or None for all of them.
LISTED = {"reaches_casadi": ("cli", "pipeline"), "rooms_of_others": None}


def is_listed(name, key):
    return name in LISTED and (LISTED[name] is None or key in LISTED[name])


def items_of(name, root, table):
    """Key -> sorted items of a ratchet."""
    found = {}
    for key, item in RATCHETS[name][0](root, table):
        found.setdefault(key, set()).add(item)
    return {key: sorted(items) for key, items in sorted(found.items())}


def complaints_of_key(name, key, items, ceiling):
    """What is more than its ceiling, and what ceiling is too high."""
    meaning = RATCHETS[name][1]
    if isinstance(ceiling, list):
        new = [f"{item}: not in the list of {key} in {CEILINGS} [{name}] ({meaning})" for item in items if item not in ceiling]
        return new + [f"{CEILINGS}: [{name}] {key}: take {item} off the list" for item in ceiling if item not in items]
    if len(items) > ceiling:
        shown = "; ".join(items[:3]) + ("; …" if len(items) > 3 else "")
        return [f"{key}: {len(items)} (ceiling {ceiling}) {meaning} ({shown}; all of them: check_architecture.py . --list {name})"]
    if len(items) < ceiling:
        return [f"{CEILINGS}: [{name}] {key}: lower the ceiling to {len(items)}"]
    return []


def check_of(name):
    """The check of a ratchet, as those of checks.py are."""

    def check(root, table):
        found, ceilings = items_of(name, root, table), table.get("ceilings", {}).get(name, {})
        complaints = []
        for key in sorted(found.keys() | ceilings.keys()):
            ceiling = ceilings.get(key, [] if is_listed(name, key) else 0)
            complaints += complaints_of_key(name, key, found.get(key, []), ceiling)
        return complaints

    return check


RATCHET_CHECKS = {name: check_of(name) for name in RATCHETS}

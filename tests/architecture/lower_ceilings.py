"""Lowers the ceilings of the ratchets to what is counted today, and says what has grown.

usage: lower_ceilings.py SOURCE_FOLDER            exit code 1 if a count is above its ceiling, which then stays
       lower_ceilings.py SOURCE_FOLDER --raise    takes over what has grown, too: the commit says why

What comes to 0 is left out.
"""

import json
import sys
from pathlib import Path

import ratchets
from check_architecture import read_table

HEAD = """# What may only become less (ratchets.py): a number, or a list where each has to be named. What is not here is 0.
# A change that makes it less lowers it by lower_ceilings.py. By hand it is raised only where a commit says why.
"""


def text_of(ceilings):
    """The file of ceilings: what each ratchet counts stands above its table."""
    text = HEAD
    for name, (_, meaning) in ratchets.RATCHETS.items():
        text += f"\n# {meaning[0].upper()}{meaning[1:]}.\n[{name}]\n"
        for key, ceiling in sorted(ceilings.get(name, {}).items()):
            shown = key if key.isidentifier() else json.dumps(key)
            if isinstance(ceiling, list):
                text += f"{shown} = [\n" + "".join(f"  {json.dumps(item)},\n" for item in ceiling) + "]\n"
            else:
                text += f"{shown} = {ceiling}\n"
    return text


def lowered_ceilings(root, table, may_rise):
    """Ceilings by ratchet and key; those of nothing are left out."""
    result = {}
    for name in ratchets.RATCHETS:
        found, ceilings = ratchets.items_of(name, root, table), table["ceilings"].get(name, {})
        result[name] = {}
        for key in found.keys() | ceilings.keys():
            items, listed = found.get(key, []), ratchets.is_listed(name, key)
            ceiling = ceilings.get(key, [] if listed else 0)
            if listed:
                ceiling = items if may_rise else [item for item in ceiling if item in items]
            else:
                ceiling = len(items) if may_rise else min(ceiling, len(items))
            if ceiling:
                result[name][key] = ceiling
    return result


def main(arguments):
    root = Path(arguments[0]).resolve()
    table = read_table()
    ceilings = lowered_ceilings(root, table, "--raise" in arguments)
    (root / ratchets.CEILINGS).write_text(text_of(ceilings), encoding="utf-8")
    table["ceilings"] = ceilings
    grown = [complaint for check in ratchets.RATCHET_CHECKS.values() for complaint in check(root, table)]
    print("\n".join(grown) if grown else "every ceiling is what is counted")
    return 1 if grown else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

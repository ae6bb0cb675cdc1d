"""The good model that malformed ones are made from, and how they are described.

Every module here has a dict FILES: name -> (content, place, expected parts of the message…). The place is None (the whole
file), a line, or "line:column"; lines count from 1.
"""

GOOD = """[model]
name = "good"
[parameters]
mu = 0.8
[states]
x = 1
v = 0
[dynamics]
x = "v"
v = "-x - mu*sign(v)"
[simulate]
until = 1
"""


def with_line(line, text, base=GOOD):
    """GOOD with one of its lines (counted from 1) replaced."""
    lines = base.splitlines()
    lines[line - 1] = text
    return "\n".join(lines) + "\n"


def after(text):
    """GOOD with more lines behind it: they begin at line 13, still within [simulate]."""
    return GOOD + text

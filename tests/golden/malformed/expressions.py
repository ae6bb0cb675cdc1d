"""Expressions, definitions, switching functions and regions that state nothing."""

from malformed.base import after, with_line


def definitions(text):
    return after("[definitions]\n" + text)  # from line 14


def modes(text):
    return after("[[modes]]\n" + text)  # from line 14


FILES = {
    "empty": (with_line(9, 'x = ""'), "9:6", "empty expression"),
    "cut": (with_line(9, 'x = "v +"'), "9:9", "expect"),
    "parenthesis open": (with_line(10, 'v = "-x - (mu"'), 10, "("),
    "parenthesis too many": (with_line(9, 'x = "v)"'), "9:7", ")"),
    "two operators": (with_line(9, 'x = "v * / x"'), "9:10", "/"),
    "no operator": (with_line(9, 'x = "2 v"'), "9:8", "v", "*"),
    "power of another language": (with_line(9, 'x = "v**2"'), "9:7", "^"),
    "equality of another language": (with_line(9, 'x = "if(v = 0, 1, 2)"'), "9:11", "="),
    "and of another language": (with_line(9, 'x = "if(v > 0 && x > 0, 1, 2)"'), "9:15", "and"),
    "conditional of another language": (with_line(9, 'x = "v > 0 ? 1 : 2"'), "9:12", "if("),
    "index of another language": (with_line(9, 'x = "x[1]"'), "9:7", "["),
    "foreign minus": (with_line(9, 'x = "−v"'), "9:6", "-"),
    "foreign comma": (with_line(9, 'x = "max(v; 1)"'), "9:11", ";"),
    "on its second line": (with_line(9, "x = '''v +\n  w'''"), "10:3", "unknown name 'w'"),
    "behind an escape": (with_line(9, r'x = "v\t+ w"'), "9:11", "unknown name 'w'"),
    "number with two points": (with_line(9, 'x = "1.2.3"'), "9:6", "1.2.3"),
    "number too large": (with_line(9, 'x = "1e999*v"'), "9:6", "beyond the range of double precision"),
    "hexadecimal": (with_line(9, 'x = "0x10"'), "9:6", "numbers are decimal"),
    "too few arguments": (with_line(9, 'x = "max(v)"'), "9:6", "max"),
    "too many arguments": (with_line(9, 'x = "sin(v, x)"'), "9:6", "sin"),
    "function without arguments": (with_line(9, 'x = "sin"'), "9:6", "sin"),
    "comparison as a number": (with_line(9, 'x = "v > 0"'), "9:8", "expected a number, found the condition", "if("),
    "chained comparison": (with_line(9, 'x = "if(0 < v < 1, 1, 2)"'), 9, "and"),
    "number as a condition": (with_line(9, 'x = "if(v, 1, 2)"'), "9:9", "expected a condition, found the number 'v'"),
    "equality of a state": (with_line(9, 'x = "if(v == 0, 1, 2)"'), 9, "== and !="),
    "nested too deeply": (with_line(9, 'x = "' + "(" * 300 + "v" + ")" * 300 + '"'), 9, "nest"),
    "signs without end": (with_line(9, 'x = "' + "-" * 300 + 'v"'), 9, "nest"),
    "sum without end": (with_line(9, 'x = "' + "v+" * 2000 + 'v"'), 9, "1000"),
    "branches without end": (with_line(9, 'x = "' + "abs(" * 8 + "v" + "".join(f"-{2**-k})" for k in range(8)) + '"'), 9,
                             "64 branches"),
    # definitions
    "cycle of one": (definitions("a = 'a + 1'\n"), "14:6", "'a' is defined by itself: a -> a"),
    "cycle of two": (definitions("a = 'b'\nb = 'a'\n"), "15:6", "defined by itself", "a -> b -> a"),
    "cycle of three, used": (definitions("a = 'x + b'\nb = '2*c'\nc = 'sin(a)'\n") + "[outputs]\no = 'b'\n", "14:10",
                             "defined by itself", "b -> c -> a -> b", "is a state"),
    "cycle through a switching function": (definitions("a = 'sign(s)'\n[switching]\ns = 'x + a'\n"), "14:11",
                                           "defined by itself", "s -> a -> s"),
    "cycle of conditions": (definitions("a = 'x > 0 and b'\nb = 'not a'\n"), "15:10", "defined by itself"),
    "cycle of a thousand": (definitions("".join(f"d{i} = 'd{(i + 1) % 1000} + 1'\n" for i in range(1000))), "1013:9",
                            "defined by itself"),
    "parameter before its declaration": (with_line(4, "mu = '2*k'\nk = 1"), "4:9", "'k' is used before it is declared"),
    "parameter of itself": (with_line(4, "mu = 'mu'"), "4:7", "'mu' is used before it is declared"),
    "parameter of a state": (with_line(4, "mu = 'x'"), "4:7", "cannot depend on 'x', which is a state"),
    "parameter of time": (with_line(4, "mu = 't'"), "4:7", "cannot depend on the time t"),
    "undefined in an unused definition": (definitions("a = 'nix'\n"), "14:6", "unknown name 'nix'"),
    "constant switching function": (after("[switching]\ns = '2*mu'\n"), "14:7", "is constant: it never changes its sign"),
    "switching function a condition": (after("[switching]\ns = 'x > 0'\n"), 14, "expected a number, found the condition"),
    # modes
    "mode without dynamics": (modes("when = 'x > 0'\n"), 13, "no `dynamics`", "absent get 0"),
    "mode without region": (modes("dynamics = { x = 1 }\n"), 13, "no `when`", "otherwise"),
    "mode of a number": (modes("when = 'x'\ndynamics = { x = 1 }\n"), 14, "expected a condition"),
    "mode with a list": (modes("when = ['x > 0']\ndynamics = { x = 1 }\n"), "14:8", "found a list"),
    "mode with a group of no name": (modes("when = 'x > 0'\ngroup = 1\ndynamics = { x = 1 }\n"), "15:9",
                                     "expected a name in quotes"),
    "dynamics of a mode a word": (modes("when = 'x > 0'\ndynamics = 'x'\n"), 15, "found the string"),
    "modes a table": (after("[modes]\nwhen = 'x > 0'\n"), 13, "[[modes]]"),
    "half uncovered": (modes("when = 'x > 1'\ndynamics = { x = 1 }\n"), 14, "uncovered", "x-1 < 0"),
    "quadrant uncovered": (modes("when = 'x > 0 and v > 0'\ndynamics = { x = 1 }\n[[modes]]\nwhen = 'x > 0 and v < 0'\n"
                                 "dynamics = { x = 2 }\n[[modes]]\nwhen = 'x < 0 and v > 0'\ndynamics = { x = 3 }\n"),
                           "20:15", "uncovered 1 sign pattern: v < 0, x < 0"),
    "overlap": (modes("when = 'x > 1'\ndynamics = { x = 1 }\n[[modes]]\nwhen = 'x > 0'\ndynamics = { x = 2 }\n"), 17,
                "overlaps", "x-1 > 0"),
    "overlap of equals": (modes("when = 'x > 1'\ndynamics = { x = 1 }\n[[modes]]\nwhen = '2*x > 2'\n"
                                "dynamics = { x = 2 }\n[[modes]]\nwhen = 'x < 1'\ndynamics = { x = 3 }\n"), 17, "overlaps"),
    "two otherwise": (modes("when = 'x > 1'\ndynamics = { x = 1 }\n[[modes]]\nwhen = 'otherwise'\ndynamics = { x = 2 }\n"
                            "[[modes]]\nwhen = 'otherwise'\ndynamics = { x = 3 }\n"), "19:1", "two modes 'otherwise'"),
    "otherwise in a condition": (modes("when = 'otherwise or x > 0'\ndynamics = { x = 1 }\n"), "14:9",
                                 "'otherwise' is no condition: it stands alone"),
    "otherwise in dynamics": (with_line(9, 'x = "otherwise"'), "9:6", "otherwise"),
    "state twice in a mode": (modes("when = 'x > 0'\ndynamics = { x = 1, x = 2 }\n"), 15, "not valid TOML"),
    "indicators with conditions": (modes("indicator = 'x'\ndynamics = { x = 1 }\n[[modes]]\nwhen = 'x > 0'\n"
                                         "dynamics = { x = 1 }\n"), 16, "in one group"),
    "indicator twice": (modes("indicator = 'x'\ndynamics = { x = 1 }\n[[modes]]\nindicator = ' x '\ndynamics = { x = 2 }\n"),
                        16, "the modes in lines 13 and 16 have the same indicator", "join them"),
    "assignment": (with_line(9, "x = 'x = v'"), "9:8", "unexpected '='", "an expression assigns nothing"),
    "implicit product": (with_line(9, "x = '2v'"), "9:7", "missing operator between '2' and 'v'", "write 2*v"),
    "minus sign of a text": (with_line(9, "x = '\u2212v'"), "9:6", "U+2212, minus sign", "write '-'"),
    "Greek letter": (with_line(9, "x = '\u03bc*v'"), 9, "U+03BC, Greek letter mu", "write 'mu'"),
    "decimal comma": (with_line(9, "x = '0,5*v'"), "9:7", "decimal numbers are written with a point"),
    "comment in an expression": (with_line(9, "x = 'v # speed'"), "9:8", "unexpected '#'", "behind the closing quote"),
    "question mark": (with_line(9, "x = 'v > 0 ? 1 : 2'"), "9:12", "unexpected '?'", "write if(condition, a, b)"),
    "indicator cut": (modes("indicator = 'x +'\ndynamics = { x = 1 }\n"), "14:17", "expect"),
    "indicator of nothing known": (modes("indicator = 'xx'\ndynamics = { x = 1 }\n"), "14:14", "unknown name 'xx'", "'x'"),
    "indicator a condition": (modes("indicator = 'x > 0'\ndynamics = { x = 1 }\n"), "14:16", "condition"),
    "indicator and when": (modes("indicator = 'x'\nwhen = 'x > 0'\ndynamics = { x = 1 }\n"), 13, "both `when` and `indicator`"),
    "name with a condition": (modes("when = 'x > 0'\nname = 'up'\ndynamics = { x = 1 }\n"), 13, "belongs to modes with"),
    "two indicators of one name": (modes("indicator = 'x'\nname = 'a'\ndynamics = { x = 1 }\n[[modes]]\nindicator = '-x'\n"
                                         "name = 'a'\ndynamics = { x = 2 }\n"), 17, "two modes are named 'a'"),
    # events
    "event cut": (after("[[events]]\nwhen = 'x -'\n"), "14:12", "expect"),
    "event of nothing known": (after("[[events]]\nwhen = 'y > 0'\n"), "14:9", "unknown name 'y'"),
    "event of an equality": (after("[[events]]\nwhen = 'x == 0'\n"), 14, "== and !="),
}

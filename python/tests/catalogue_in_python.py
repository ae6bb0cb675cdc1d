"""States a model file once more, in Python: its tables by the calls of a Builder, its expressions by Python's operators.

The language of model files is nearly that of Python, so an expression is read by Python's parser, with `**` for `^`, and
evaluated with what the Builder gave for the names.
"""

import ast
import re
import tomllib

import saltus

FUNCTIONS = (
    "sin cos tan asin acos atan atan2 sinh cosh tanh exp log log10 sqrt hypot pow step sign abs max min floor mod if_ t pi"
).split()
#: Keys of [optimize] whose texts are words.
WORDS = {"path_constraints_at", "cross_complementarity", "start", "at", "file", "result", "norm"}


class _ForBuilder(ast.NodeTransformer):
    """`and or not` become `& | ~`; a number stays what is written, so that Python does not compute with it."""

    def __init__(self, text):
        self.text = text

    def visit_BoolOp(self, node):
        values = [self.visit(value) for value in node.values]
        operator = ast.BitAnd() if isinstance(node.op, ast.And) else ast.BitOr()
        joined = values[0]
        for value in values[1:]:
            joined = ast.BinOp(joined, operator, value)
        return joined

    def visit_UnaryOp(self, node):
        operand = self.visit(node.operand)
        return ast.UnaryOp(ast.Invert() if isinstance(node.op, ast.Not) else node.op, operand)

    def visit_Constant(self, node):
        return ast.Call(ast.Name("number", ast.Load()), [ast.Constant(ast.get_source_segment(self.text, node))], [])


class _Names(dict):
    """What the Builder gave, else a name that it will give."""

    def __init__(self, builder):
        super().__init__({name: getattr(saltus, name) for name in FUNCTIONS})
        self["number"] = saltus.Expression
        self._builder = builder

    def __missing__(self, name):
        return saltus.Expression(name, owner=self._builder)


class _Statement:
    def __init__(self, file, folder):
        about = file["model"]
        self.builder = saltus.Builder(about["name"], about.get("description", ""), about.get("inclusion"))
        self.names = _Names(self.builder)
        self.file = file
        self.folder = folder

    def value(self, text):
        """A number as it is, a text as the expression that it states."""
        if not isinstance(text, str):
            return text
        python = re.sub(r"\bif\s*\(", "if_(", text).replace("^", "**").strip()
        tree = ast.fix_missing_locations(_ForBuilder(python).visit(ast.parse(python, mode="eval")))
        return eval(compile(tree, text, "eval"), {"__builtins__": {}}, self.names)

    def values(self, table):
        return {key: self.value(entry) for key, entry in table.items()}

    def all_values(self, entry, key=""):
        """The same of tables in tables; two-sided comparisons, which Python would split, stay texts."""
        if isinstance(entry, dict):
            return {name: self.all_values(inner, name) for name, inner in entry.items()}
        if isinstance(entry, list):
            return [self.all_values(inner, key) for inner in entry]
        if key == "file":
            return str(self.folder / entry)
        two_sided = isinstance(entry, str) and len(re.findall("<=|>=|==", entry)) > 1
        return entry if two_sided or key in WORDS else self.value(entry)

    def beside(self, entry, main="initial"):
        """(value, keywords) of a number, a text, or a table with `initial`."""
        if not isinstance(entry, dict):
            return self.value(entry), {}
        words = {key: inner if key in ("unit", "label", "free") else self.value(inner) for key, inner in entry.items()}
        return words.pop(main, 0), words

    def state_all(self):
        m, file = self.builder, self.file
        for part, declare in (("parameters", m.parameter), ("states", m.state), ("controls", m.control)):
            for name, entry in file.get(part, {}).items():
                value, words = self.beside(entry)
                self.names[name] = declare(name, value, **words)
        for name, table in file.get("tables", {}).items():
            self.names[name] = m.table(name, **table)
        for entry in file.get("hysteresis", []):
            entry = {**entry, **self.values({key: entry[key] for key in ("input", "on", "off", "initial") if key in entry})}
            self.names[entry["name"]] = m.hysteresis(**entry)
        for part, declare in (("definitions", m.define), ("switching", m.switching)):
            for name, text in file.get(part, {}).items():
                self.names[name] = declare(name, self.value(text))
        for name, text in file.get("dynamics", {}).items():
            m.rate(name, self.value(text))
        self.state_modes()
        self.state_mechanics()
        self.state_what_happens()
        return m

    def state_modes(self):
        for entry in self.file.get("modes", []):
            rates, more = self.values(entry["dynamics"]), {key: entry[key] for key in ("group", "name") if key in entry}
            if "indicator" in entry:
                self.builder.region(self.value(entry["indicator"]), rates, **more)
            elif entry["when"] == "otherwise":
                self.builder.otherwise(rates, **more)
            else:
                self.builder.mode(self.value(entry["when"]), rates, **more)

    def state_mechanics(self):
        mechanics = dict(self.file.get("mechanics", {}))
        if mechanics:
            positions, velocities = mechanics.pop("positions"), mechanics.pop("velocities")
            words = {key: mechanics.pop(key) for key in ("coriolis",) if key in mechanics}
            self.builder.mechanics(positions, velocities, **words, **self.all_values(mechanics))
        for entry in self.file.get("contacts", []):
            self.builder.contact(entry["name"], **self.all_values({key: entry[key] for key in entry if key != "name"}))

    def state_what_happens(self):
        m, file = self.builder, self.file
        for entry in file.get("jumps", []):
            more = {key: entry[key] for key in entry if key not in ("when", "set")}
            m.jump(self.value(entry["when"]), self.values(entry["set"]), **more)
        for entry in file.get("events", []):
            m.event(self.value(entry["when"]), **{key: entry[key] for key in entry if key != "when"})
        for name, entry in file.get("outputs", {}).items():
            value, words = self.beside(entry, "value")
            m.output(name, value, **words)
        m.simulation(**file["simulate"])
        if "optimize" in file:
            m.optimal_control(**self.all_values(file["optimize"]))
        if "time_freezing" in file:
            m.time_freezing(**self.all_values(file["time_freezing"]))


def restated(path):
    """The builder that states what a model file states."""
    return _Statement(tomllib.loads(path.read_text()), path.parent).state_all()

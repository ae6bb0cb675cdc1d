"""Right-hand sides and errors of CVODE and of SciPy's LSODA and BDF on the stiff models, beside the choice of Saltus.

usage: peers.py TOOL [--models FOLDER] [--rtol 1e-4,1e-6,1e-8,1e-10] [--out results/stiff_peers.md]

Counts do not depend on the machine: they are calls of the right-hand side, those for differences of a Jacobian among them.
CVODE (BDF, dense, from scikit-sundae) stops at the zeros of every switching function and begins anew behind them; SciPy's
methods pass them, as its search for events cannot begin on a zero. Nothing but Saltus knows sliding. Errors are those of
run.py: of the end state, relative to 1e-3 and the state, against radau13 at rtol = 1e-12. A peer that is not installed is a
row that says so.
"""

import argparse
import ast
import math
import re
import tomllib
from pathlib import Path

import run

MOST_EVALUATIONS = 3_000_000
MOST_EVENTS = 5_000
NAMES = {"sin": math.sin, "cos": math.cos, "exp": math.exp, "pi": math.pi, "IF": lambda c, a, b: a if c else b,
         "sign": lambda x: float(x > 0) - float(x < 0)}


class GivenUp(Exception):
    """More evaluations or events than anybody waits for."""


class Model:
    """A model file of these benchmarks as plain functions: `rates` and `zeros` of (t, x, discrete states)."""

    def __init__(self, path):
        text = tomllib.loads(Path(path).read_text(encoding="utf-8"))
        self.start = [float(value) for value in text["states"].values()]
        self.until = float(text["simulate"]["until"])
        self.hysteresis = text.get("hysteresis", [])
        dynamics = [text["dynamics"][name] for name in text["states"]]
        definitions = {**text.get("switching", {}), **text.get("definitions", {})}
        zeros = []
        for expression in (*definitions.values(), *dynamics):
            zeros += [word for word in self.nonsmooth(expression) if word not in zeros]
        # Of a hysteresis: the threshold at which it turns next.
        zeros += [f"{h['input']} - ({h['off']} if {h['name']} else {h['on']})" for h in self.hysteresis]
        head = [f"    {', '.join(text['states'])}, = x"]
        head += [f"    {h['name']} = discrete[{k}]" for k, h in enumerate(self.hysteresis)]
        head += [f"    {name} = {value!r}" for name, value in text.get("parameters", {}).items()]
        head += [f"    {name} = {self.python(value)}" for name, value in definitions.items()]
        functions = dict(NAMES)
        for name, values in (("rates", map(self.python, dynamics)), ("zeros", zeros)):
            source = "\n".join([f"def {name}(t, x, discrete):", *head, f"    return [{', '.join(values)}]"])
            exec(compile(source, str(path), "exec"), functions)  # noqa: S102: model files of this folder
        self.rates, self.zeros, self.count = functions["rates"], functions["zeros"], len(zeros)

    @staticmethod
    def python(expression):
        return re.sub(r"\bif\(", "IF(", expression).replace("^", "**")

    @classmethod
    def nonsmooth(cls, expression):
        """What `sign` and `if` of an expression look at."""
        for node in ast.walk(ast.parse(cls.python(expression), mode="eval")):
            if isinstance(node, ast.Call) and node.func.id == "sign":
                yield ast.unparse(node.args[0])
            elif isinstance(node, ast.Call) and node.func.id == "IF":
                yield ast.unparse(node.args[0].left)  # all of them are comparisons with 0

    def turn(self, zero, discrete):
        """Discrete states behind a zero."""
        first = self.count - len(self.hysteresis)
        return [1 - value if zero == first + k else value for k, value in enumerate(discrete)]


class Counted:
    """The right-hand side of a model, and how often it was asked for."""

    def __init__(self, model):
        self.model, self.calls = model, 0
        self.discrete = [h["initial"] for h in model.hysteresis]

    def __call__(self, t, x):
        self.calls += 1
        if self.calls > MOST_EVALUATIONS:
            raise GivenUp
        return self.model.rates(t, x, self.discrete)


def cvode(model, rtol):
    """(end state, evaluations) of CVODE with a new beginning at each zero."""
    from sksundae.cvode import CVODE  # noqa: PLC0415

    rates = Counted(model)

    def fill(t, x, slope):
        slope[:] = rates(t, x)

    def zeros(t, x, values):
        values[:] = model.zeros(t, x, rates.discrete)

    events = {"eventsfn": zeros, "num_events": model.count} if model.count else {}
    t, x = 0.0, model.start
    for _ in range(MOST_EVENTS):
        solver = CVODE(fill, method="BDF", rtol=rtol, atol=1e-3 * rtol, max_num_steps=MOST_EVALUATIONS, **events)
        found = solver.solve([t, model.until], x)
        t, x = found.t[-1], found.y[-1]
        if t >= model.until:
            return x, rates.calls
        if found.i_events is None or not len(found.i_events):
            raise GivenUp
        for zero, value in enumerate(found.i_events[-1]):
            if value:
                rates.discrete = model.turn(zero, rates.discrete)
    raise GivenUp


def scipy_method(method):
    def end(model, rtol):
        from scipy.integrate import solve_ivp  # noqa: PLC0415

        if model.hysteresis:
            raise GivenUp
        rates = Counted(model)
        found = solve_ivp(rates, (0.0, model.until), model.start, method=method, rtol=rtol, atol=1e-3 * rtol)
        if not found.success:
            raise GivenUp
        return found.y[:, -1], rates.calls

    return end


PEERS = {"CVODE (BDF), events": cvode, "SciPy LSODA, no events": scipy_method("LSODA"),
         "SciPy BDF, no events": scipy_method("BDF")}


def cell(peer, model, rtol, exact):
    try:
        x, calls = peer(model, rtol)
    except (GivenUp, ArithmeticError, RuntimeError):
        return "none"
    return f"{calls}, {run.error_of({'final': {'x': list(x)}}, exact):.0e}"


def row(peer, model, tolerances, exact):
    try:
        return " | ".join(cell(peer, model, rtol, exact) for rtol in tolerances)
    except ImportError as error:
        return " | ".join([f"not installed ({error.name})", *[""] * (len(tolerances) - 1)])


def own_cell(tool, path, rtol, exact):
    result = run.simulate(tool, path, "auto", rtol)
    return "none" if result is None else f"{result['statistics']['rhs_evaluations']}, {run.error_of(result, exact):.0e}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("--models", default=str(Path(__file__).parent / "models"))
    parser.add_argument("--rtol", default="1e-4,1e-6,1e-8,1e-10")
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    tolerances = [float(word) for word in arguments.rtol.split(",")]
    run.LONGEST = 600.0  # a reference is not to depend on the machine
    lines = ["# Stiff models with switches: right-hand sides and errors", "",
             "Made by `benchmarks/stiff/peers.py`: calls of the right-hand side, and the error of the end state relative to 1e-3 and the state. `none`: does not end",
             f"within {MOST_EVALUATIONS} calls, fails, or (without events) has a hysteresis to turn. It does not depend on the machine.", "",
             f"| model | method | {' | '.join(f'rtol {rtol:g}' for rtol in tolerances)} |",
             f"| --- | --- |{' ---: |' * len(tolerances)}"]
    for path in sorted(Path(arguments.models).glob("*.toml")):
        exact = run.simulate(arguments.tool, str(path), "radau13", 1e-12)
        model = Model(path)
        own = " | ".join(own_cell(arguments.tool, str(path), rtol, exact) for rtol in tolerances)
        rows = {"Saltus, auto": own, **{name: row(peer, model, tolerances, exact) for name, peer in PEERS.items()}}
        for name, cells in rows.items():
            lines.append(f"| {path.stem} | {name} | {cells} |")
            print(lines[-1], flush=True)
    if arguments.out:
        arguments.out.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

"""Expressions and matrices of CasADi, SymPy, NumPy and SciPy in a builder."""

import numpy as np
import pytest

import saltus


def pendulum():
    b = saltus.Builder("m")
    return b, b.state("x", 1), b.state("v", 0)


def test_casadi_in_the_problem_of_an_optimisation():
    casadi = pytest.importorskip("casadi")
    x, u = casadi.SX.sym("x"), casadi.SX.sym("u")
    cost = casadi.sin(x) + casadi.sin(x)**2 + u**2
    b = saltus.Builder("m")
    b.state("x", 1), b.control("u", lower=-1, upper=1)
    b.rate("x", u)
    b.optimal_control(running_cost=cost, horizon={"free": True, "initial": casadi.SX(1), "lower": 0.5, "upper": 2},
                      terminal_constraints=[x == 0.5], path_constraints=[x <= 2], control_intervals=4,
                      least_squares=[{"of": casadi.vertcat(x, u), "reference": [0, 0], "weight": [1, 0.1]}])
    text = b.to_toml()
    assert "@" not in text and "sq(" not in text
    assert 'running_cost = "sin(x)+sin(x)^2+u^2"' in text
    assert 'of = ["x", "u"]' in text
    assert abs(b.optimize().require().final["x"] - 0.5) < 1e-6


def test_casadi_in_drawings_and_masses():
    casadi = pytest.importorskip("casadi")
    x = casadi.SX.sym("x")
    height = casadi.sin(x) + casadi.sin(x)**2
    b, *_ = pendulum()
    b.mechanics(["x"], ["v"], force={"v": -9.81 + casadi.SX.sym("x")*0}, draw=[{"point": [0, height], "radius": 0.1}])
    b.contact("ground", gap=x, restitution=0.5)
    assert 'point = [0, "sin(x)+sin(x)^2"]' in b.to_toml()
    assert b.simulate(until=1).events[0].kind == "impact"


def slid(stated):
    """A block in the plane on a floor that pushes and brakes it; `stated` says how positions and tangent are written."""
    b = saltus.Builder("block")
    names = b.states(["x", "z", "vx", "vz"], [0, 0, 2, 0])
    stated(b, *names)
    return b.to_toml(), b.simulate(until=1).final["x"]


@pytest.mark.parametrize("package", ["casadi", "sympy", "numpy"])
def test_mechanics_and_contacts_are_stated_by_vectors(package):
    def by_dicts(b, x, z, vx, vz):
        b.mechanics([x, z], [vx, vz], force={vz: -10, vx: 1})
        b.contact("floor", gap=z, tangent={x: 1}, friction=0.5)

    def by_vectors(b, *own):
        if package == "casadi":
            ca = pytest.importorskip("casadi")
            x, z, vx, vz = map(ca.SX.sym, ("x", "z", "vx", "vz"))
            q, v, force = ca.vertcat(x, z), ca.vertcat(vx, vz), ca.vertcat(1, -10)
            tangent = ca.jacobian(x + 1, q)
        elif package == "sympy":
            sympy = pytest.importorskip("sympy")
            x, z, vx, vz = sympy.symbols("x z vx vz")
            q, v, force = sympy.Matrix([x, z]), sympy.Matrix([vx, vz]), sympy.Matrix([1, -10])
            tangent = sympy.Matrix([x + 1]).jacobian(q)
        else:
            x, z, vx, vz = own
            q, v, force, tangent = np.array([x, z]), np.array([vx, vz]), np.array([1, -10]), np.array([[1, 0]])
        b.mechanics(q, v, force=force)
        b.contact("floor", gap=z, tangent=tangent, friction=0.5)

    expected, stated = slid(by_dicts), slid(by_vectors)
    assert stated[1] == expected[1]
    assert 'positions = ["x", "z"]' in stated[0] and "tangent = { x = 1 }" in stated[0]

    def by_symbols(b, *own):
        names = ("x", "z", "vx", "vz")
        if package == "casadi":
            own = [pytest.importorskip("casadi").SX.sym(name) for name in names]
        elif package == "sympy":
            own = pytest.importorskip("sympy").symbols(" ".join(names))
        x, z, vx, vz = own
        b.mechanics([x, z], [vx, vz], force={vx: 1, vz: -10})
        b.contact("floor", gap=z, tangent={x: 1}, friction=0.5)

    assert slid(by_symbols)[1] == expected[1]


def test_tangents_are_the_rows_of_a_matrix():
    casadi = pytest.importorskip("casadi")
    texts = []
    for rows in ([{"x": 1}, {"y": 1}], casadi.DM([[1, 0, 0], [0, 1, 0]]), np.eye(3)[:2]):
        b = saltus.Builder("puck")
        b.states(["x", "y", "z"], 0), b.states(["u", "v", "w"], [1, 1, 0])
        b.mechanics(["x", "y", "z"], ["u", "v", "w"], force=[0, 0, -10])
        b.contact("table", gap=casadi.SX.sym("z"), tangents=rows, friction=0.5)
        texts.append(b.to_toml().replace("1.0", "1"))
    assert texts[0] == texts[1] == texts[2]


def test_vectors_that_do_not_fit_are_refused():
    b = saltus.Builder("m")
    x, z, vx, vz = b.states(["x", "z", "vx", "vz"], 0)
    with pytest.raises(saltus.ModelError, match="state m.mechanics first"):
        b.contact("floor", gap=z, tangent=[1, 0])
    with pytest.raises(saltus.ModelError, match="force: expected a dict by states, or a vector in their order, found 3"):
        b.mechanics([x, z], [vx, vz], force=3)
    b.mechanics([x, z], [vx, vz])
    with pytest.raises(saltus.ModelError, match="tangent has 3 entries"):
        b.contact("floor", gap=z, tangent=[1, 0, 0])
    with pytest.raises(saltus.ModelError, match="2 names and initial values of shape"):
        b.states(["a", "b"], [1, 2, 3])
    with pytest.raises(saltus.ModelError, match="saltus.sign"):
        b.contact("floor", gap="z")


@pytest.mark.parametrize("make", ["casadi", "numpy", "sympy", "scipy", "lists"])
def test_a_mass_is_a_matrix_of_any_package(make):
    if make == "casadi":
        casadi = pytest.importorskip("casadi")
        mass = casadi.SX.eye(2)
        mass[0, 0] = 2 + casadi.SX.sym("q1")**2
    elif make == "sympy":
        sympy = pytest.importorskip("sympy")
        mass = sympy.Matrix([[2 + sympy.Symbol("q1")**2, 0], [0, 1]])
    elif make == "scipy":
        mass = pytest.importorskip("scipy.sparse").diags([2.0, 1.0])
    else:
        mass = np.diag([2, 1]) if make == "numpy" else [[2, 0], [0, 1]]
    b = saltus.Builder("m")
    q, v = b.states("q", [0, 0]), b.states("v", [1, 0])
    b.mechanics(list(q), list(v), mass=mass, force={v[0]: 0, v[1]: 4})
    assert b.simulate(until=1).final["q2"] == pytest.approx(2, abs=1e-8)
    with pytest.raises(saltus.ModelError, match="expected 2 rows of 2 entries"):
        c = saltus.Builder("m")
        c.mechanics(list(c.states("q", [0, 0])), list(c.states("v", [1, 0])), mass=np.eye(3))


def test_sympy_expressions():
    sympy = pytest.importorskip("sympy")
    x, k, t = sympy.symbols("x k t")
    b = saltus.Builder("m")
    X, K = b.state("x", 0.3), b.parameter("k", 2)
    forms = [
        (sympy.sin(x)/2 + k*x**2 - 3, lambda x, t: np.sin(x)/2 + 2*x**2 - 3),
        (sympy.sqrt(x) + sympy.exp(-x) + sympy.log(x) + sympy.pi, lambda x, t: np.sqrt(x) + np.exp(-x) + np.log(x) + np.pi),
        (sympy.Rational(1, 3)*x**-2 - x**sympy.Rational(3, 2), lambda x, t: x**-2/3 - x**1.5),
        (sympy.Abs(x - 1) + sympy.Max(x, 1, k) - sympy.Min(x, t), lambda x, t: abs(x - 1) + 2 - min(x, t)),
        (sympy.Piecewise((x**2, x < 1), (2*x, True)), lambda x, t: x**2),
        (sympy.Piecewise((1, sympy.And(x > 1, t > 0)), (2, sympy.Or(x < 0.1, sympy.Not(t > 5))), (3, True)), lambda x, t: 2),
        (sympy.Heaviside(x - 1) + sympy.sign(x) + sympy.tan(x) + sympy.atan2(x, 2), lambda x, t: 1 + np.tan(x) + np.arctan2(x, 2)),
        (-x*k/(1 + x) - 0.5, lambda x, t: -2*x/(1 + x) - 0.5),
        (-(x + 1), lambda x, t: -x - 1),
        (sympy.Integer(0), lambda x, t: 0),
    ]
    b.rate(X, 0)
    for number, (form, _) in enumerate(forms):
        b.output(f"y{number}", form)
    r = b.simulate(until=1, points=2)
    for number, (form, value) in enumerate(forms):
        assert r[f"y{number}"][0] == pytest.approx(value(0.3, 0.0), rel=1e-12), form
    assert str(sympy.Symbol("x") + X) == "x+x" and str(X*sympy.cos(t)) == "x*cos(t)"
    position = sympy.Function("x")(t)
    assert str(X - position) == "x-x"
    for form, said in [(sympy.gamma(x), "no 'gamma'"), (sympy.I*x, "I"), (sympy.Derivative(position, t), "Derivative"),
                       (sympy.Piecewise((x, x > 1)), "nothing holds")]:
        with pytest.raises(saltus.ModelError, match=said):
            X + form
    K - 1


def test_sympy_states_a_model():
    sympy = pytest.importorskip("sympy")
    q, w = sympy.symbols("q w")
    b = saltus.Builder("pendulum")
    Q, W = b.state("q", 1), b.state("w", 0)
    b.rate([Q, W], sympy.Matrix([w, -sympy.sin(q) - 0.1*sympy.sign(w)]))
    b.event(q, name="down", direction="down")
    assert b.simulate(until=3).events[-1].name == "down"


def test_sparse_matrices():
    sparse = pytest.importorskip("scipy.sparse")
    for make in (sparse.csr_matrix, sparse.csc_array, sparse.coo_matrix):
        A = make(np.array([[-2.0, 1, 0], [1, -2, 1], [0, 1, -2]]))
        b = saltus.Builder("chain")
        X = b.states("x", [1, 0, 0])
        rates = saltus.array(A) @ X
        assert [str(rate) for rate in rates] == ["-2.0*x1+x2", "x1+-2.0*x2+x3", "x2+-2.0*x3"]
        b.rate(X, rates)
        dense = saltus.Builder("dense")
        Y = dense.states("x", [1, 0, 0])
        dense.rate(Y, A.toarray() @ Y)
        assert b.simulate(until=1).final.x == pytest.approx(dense.simulate(until=1).final.x, abs=1e-9)
        assert [str(entry) for entry in X @ A] == [str(rate) for rate in rates]
        with pytest.raises(ValueError, match="expected 3 rows"):
            saltus.array(A) @ X[:2]
        with pytest.raises(TypeError, match=r"write saltus.array\(A\) @ X"):
            A @ X
    assert (saltus.array(sparse.csr_matrix((2, 3))) @ X).tolist() == [0, 0]


def test_states_of_two_axes():
    b = saltus.Builder("plate")
    T = b.states("T", np.arange(6.0).reshape(2, 3), unit="K", label="temperature")
    assert T.shape == (2, 3) and str(T[1, 2]) == "T2_3"
    b.rate(T, np.roll(T, 1, axis=1) - T)
    r = b.simulate(until=20)
    assert r.final.x == pytest.approx([1, 1, 1, 4, 4, 4], abs=1e-4)
    with pytest.raises(saltus.ModelError, match="of one or two axes"):
        b.states("z", np.zeros((1, 1, 1)))
    with pytest.raises(saltus.ModelError, match=r"lower has the shape \(3,\)"):
        b.states("z", [0, 0], lower=[1, 2, 3])
    with pytest.raises(saltus.ModelError, match="taken"):
        b.states("T", np.zeros((3, 3)))
    b.states("S", [0, 0])  # nothing of what failed is left


def test_parameters_and_controls_are_arrays():
    b = saltus.Builder("m")
    k = b.parameters("k", [1, 2], unit=["1/s", "1/h"])
    u = b.controls("u", [0.5, 0.25], lower=-1, upper=[1, 2])
    x = b.states("x", [1, 1])
    b.rate(x, -k*x + u)
    r = b.simulate(until=1, set={"k1": 0})
    assert r.final["x1"] == pytest.approx(1.5, abs=1e-9)
    assert 'u2 = { initial = 0.25, lower = -1, upper = 2 }' in b.to_toml()
    assert 'k2 = { initial = 2, unit = "1/h" }' in b.to_toml()


def test_heaviside_of_numpy():
    b = saltus.Builder("m")
    X = b.states("x", [1, 2])
    assert [str(entry) for entry in np.heaviside(X - 1, 0.5)] == ["step(x1-1)", "step(x2-1)"]
    assert str(np.heaviside(X[0], 0)) == "step(x1)"
    assert str(np.maximum(X[0], 3)) == "max(x1,3)"
    assert str(np.float64(2)*X[0]) == "2.0*x1"
    assert [str(entry) for entry in np.array([1.0, 2.0])*X[0]] == ["1.0*x1", "2.0*x1"]

"""Arrays of expressions: operators, comparisons, conditions, what numpy does with them, and models stated with them."""

import numpy as np
import pytest

import saltus


def texts(array):
    return [str(entry) for entry in np.asarray(array).flat]


X = saltus.array([saltus.Expression("x1"), saltus.Expression("x2")])
Y = X[::-1]


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (lambda: X > 0, ["x1>0", "x2>0"]),
        (lambda: 0 < X, ["x1>0", "x2>0"]),
        (lambda: X <= Y, ["x1<=x2", "x2<=x1"]),
        (lambda: X >= np.array([1.0, 2.0]), ["x1>=1.0", "x2>=2.0"]),
        (lambda: np.array([X[0], X[1]]) < Y, ["x2>x1", "x1>x2"]),
        (lambda: X == 1, ["x1==1", "x2==1"]),
        (lambda: X != Y, ["x1!=x2", "x2!=x1"]),
        (lambda: X > X[0], ["x1>x1", "x2>x1"]),
        (lambda: X[0] > X, ["x1>x1", "x1>x2"]),
        (lambda: np.greater(X, 0), ["x1>0", "x2>0"]),
        (lambda: (X > 0) & (X < 1), ["x1>0 and x1<1", "x2>0 and x2<1"]),
        (lambda: (X > 0) | (Y[0] > 0), ["x1>0 or x2>0", "x2>0 or x2>0"]),
        (lambda: (Y[0] > 0) | (X > 0), ["x2>0 or x1>0", "x2>0 or x2>0"]),
        (lambda: ~(X > 0), ["not x1>0", "not x2>0"]),
        (lambda: np.logical_and(X > 0, X < 1), ["x1>0 and x1<1", "x2>0 and x2<1"]),
        (lambda: np.logical_not(X > 0), ["not x1>0", "not x2>0"]),
        (lambda: np.any(X > 0), ["x1>0 or x2>0"]),
        (lambda: (X > 0).all(), ["x1>0 and x2>0"]),
        (lambda: saltus.if_(X > 0, X, 0), ["if(x1>0,x1,0)", "if(x2>0,x2,0)"]),
        (lambda: saltus.if_(X > 0, Y, np.array([3, 4])), ["if(x1>0,x2,3)", "if(x2>0,x1,4)"]),
        (lambda: saltus.if_(X[0] > 0, X, Y), ["if(x1>0,x1,x2)", "if(x1>0,x2,x1)"]),
        (lambda: np.where(X > 0, X, 0), ["if(x1>0,x1,0)", "if(x2>0,x2,0)"]),
        (lambda: np.maximum(X, 0), ["max(x1,0)", "max(x2,0)"]),
        (lambda: np.sign(X), ["sign(x1)", "sign(x2)"]),
        (lambda: np.abs(X), ["abs(x1)", "abs(x2)"]),
        (lambda: np.max(X), ["max(x1,x2)"]),
        (lambda: np.clip(X, 0, 1), ["min(max(x1,0),1)", "min(max(x2,0),1)"]),
        # What is computed with an array of this kind is one.
        (lambda: (2 * X - 1)[:1] > 0, ["2*x1-1>0"]),
        (lambda: np.concatenate([X, Y]) > 0, ["x1>0", "x2>0", "x2>0", "x1>0"]),
        (lambda: np.array([[0, 1], [1, 0]]) @ X > 0, ["0*x1+1*x2>0", "1*x1+0*x2>0"]),
        (lambda: X.reshape(2, 1) > X, ["x1>x1", "x1>x2", "x2>x1", "x2>x2"]),
        (lambda: saltus.sin(np.array([X[0], X[1]])) > 0, ["sin(x1)>0", "sin(x2)>0"]),
        (lambda: X[0] * np.array([1, 2]) > 0, ["x1*1>0", "x1*2>0"]),
    ],
)
def test_arrays_work_entry_by_entry(made, expected):
    found = made()
    assert texts(found) == expected
    assert not isinstance(found, np.ndarray) or type(found) is saltus.Array


def test_arrays_in_place():
    made = X.copy()
    made += 1
    assert texts(made) == ["x1+1", "x2+1"]
    assert texts(X) == ["x1", "x2"]


def test_numbers_stay_numbers():
    assert np.where(np.array([True, False]), np.array([1, 2]), 0).tolist() == [1, 0]
    assert texts(np.where([True, False], X, 0)) == ["x1", "0"]
    assert type(np.array([1.0]) > 0) is np.ndarray


def test_what_numpy_decides_for_its_own_arrays_is_told():
    """An array of numpy itself has comparisons of type bool only."""
    for made in (lambda: np.array([X[0], X[1]]) > 0, lambda: np.sign(np.array([X[0]]))):
        with pytest.raises(saltus.ModelError, match=r"saltus.array\(\[x, v\]\) > 0"):
            made()
    assert str(np.maximum(X[0], 0)) == f"max({X[0]},0)"


def test_a_model_of_arrays():
    """A ring of relays, once with arrays and once entry by entry."""
    m = saltus.Builder("ring")
    x = m.states("x", [1, 2, 0.5])
    on = x < 1
    m.rate(x, saltus.if_(on & (np.roll(x, 1) > 0.2), 3, 0) - x)
    one = saltus.Builder("ring")
    x1, x2, x3 = one.state("x1", 1), one.state("x2", 2), one.state("x3", 0.5)
    for x, before in ((x1, x3), (x2, x1), (x3, x2)):
        one.rate(x, saltus.if_((x < 1) & (before > 0.2), 3, 0) - x)
    assert m.to_toml() == one.to_toml()
    assert m.simulate(until=3).x.tobytes() == one.simulate(until=3).x.tobytes()
    with pytest.raises(saltus.ModelError, match="one for every state"):
        m.rate(m.states("y", [1, 2]), [1, 2, 3])
    with pytest.raises(saltus.ModelError, match='m.states'):
        m.state("z", [1, 2])


def test_whole_divisions():
    assert texts(saltus.array([saltus.t // 2, 7 % saltus.t, 7 // saltus.t])) == ["floor(t/2)", "mod(7,t)", "floor(7/t)"]


def term_by_term(rows, entries, numbers_first):
    sums = []
    for row in rows:
        terms = [weight * entry if numbers_first else entry * weight for weight, entry in zip(row, entries)]
        whole = terms[0]
        for term in terms[1:]:
            whole = whole + term
        sums.append(whole)
    return sums


def full_text(whole):
    """With the text of every part in its place."""
    parts, text = {}, whole.text
    waiting = [whole]
    while waiting:
        found = waiting.pop().parts
        parts.update(found)
        waiting += found.values()
    while any(key in text for key in parts):
        for key, part in parts.items():
            text = text.replace(key, f"{{{part.text}}}")
    return text


@pytest.mark.parametrize(("rows", "columns"), [(1, 1), (2, 3), (3, 1500), (1, 4000)])
@pytest.mark.parametrize("whole_numbers", [False, True])
def test_a_product_with_a_matrix_has_the_text_of_its_sums(rows, columns, whole_numbers):
    x = saltus.Builder("m").states("x", np.ones(columns))
    entries = saltus.step(x - 0.5)
    entries[0] = x[0] + 2 * x[-1]
    matrix = np.random.default_rng(0).normal(size=(rows, columns))
    matrix[0, 0], matrix[0, -1] = 0, 1e-9
    matrix = (10 * matrix).astype(int) if whole_numbers else matrix
    for made, numbers_first in ((matrix @ entries, True), (entries @ matrix.T, False)):
        for found, expected in zip(made, term_by_term(matrix.tolist(), list(entries), numbers_first)):
            assert full_text(found) == full_text(expected)
            assert (found.height, found.reach, found.depth, found.level) == (
                expected.height, expected.reach, expected.depth, expected.level
            )  # fmt: skip
    alone = matrix[0] @ entries
    assert isinstance(alone, saltus.Expression)
    assert full_text(alone) == full_text((matrix @ entries)[0])


def test_a_matrix_that_does_not_fit_is_refused():
    x = saltus.Builder("m").states("x", np.ones(3))
    with pytest.raises(ValueError):
        np.ones((2, 2)) @ x
    with pytest.raises(saltus.ModelError, match="nan"):
        np.array([[1.0, np.nan, 0.0]]) @ x
    with pytest.raises(saltus.ModelError, match="more than 5000 terms"):
        np.ones((1, 5100)) @ saltus.Builder("m").states("y", np.ones(5100))


@pytest.fixture(scope="module")
def ring():
    m = saltus.Builder("ring")
    p, m_ = m.states("p", [1, 0, 0]), m.states("T", [[1, 2], [3, 4]])
    m.rate(p, np.roll(p, 1) - p)
    m.rate(m_, -m_)
    m.event(p[0] - 0.5, name="half")
    return m, p


def test_a_result_knows_arrays(ring):
    m, p = ring
    r = m.simulate(until=1, points=3)
    assert r["p"].tolist() == np.column_stack([r["p1"], r["p2"], r["p3"]]).tolist() == r[p].tolist() == r["p*"].tolist()
    assert r["T"].shape == (len(r.t), 2, 2) and r["T"][:, 1, 0].tolist() == r["T2_1"].tolist()
    assert r.final["p"].tolist() == [r.final["p1"], r.final["p2"], r.final["p3"]] and r.final["T"].shape == (2, 2)
    for name in ("P", "q*", "p1_"):
        with pytest.raises(KeyError):
            r[name]
    s = m.sweep(p1=[1, 2], until=1)
    assert s["p"].tolist() == [[s[f"p{i}"][k] for i in (1, 2, 3)] for k in (0, 1)]


def test_an_array_is_set_entry_by_entry(ring):
    m, p = ring
    r = m.simulate(until=1, set={"p": [1, 2, 3], "T": np.zeros((2, 2))})
    assert r["p"][0].tolist() == [1, 2, 3] and not r["T"].any()
    assert m.simulate(until=2, start=r, set={"p": [0, 0, 0]})["p"][0].tolist() == [0, 0, 0]
    assert m.sweep(p1=[1], set={"T": np.zeros((2, 2))}, until=1)["T1_1"].tolist() == [0]
    with pytest.raises(saltus.ModelError, match="expected one value"):
        m.simulate(until=1, set={"p": [1, 2, 3, 4]})
    with pytest.raises(saltus.ModelError, match="changed twice"):
        m.sweep(p1=[1], set={"p": [1, 2, 3]}, until=1)


def test_events_know_states_by_their_names(ring):
    m, p = ring
    m.jump(at=[0.25], set={p[1]: 5}, name="dose")
    events = m.simulate(until=1).events
    jump = events["dose"][0]
    assert jump.states[:3] == ["p1", "p2", "p3"]
    assert (jump["p2"], jump["p2(after)"], jump["p"].tolist()) == (jump.x[1], 5, jump.x[:3].tolist())
    table = events.table()
    assert table["p2(after)"].tolist() == events.x_after[:, 1].tolist() and table["p1"].tolist() == events.x[:, 0].tolist()
    with pytest.raises(KeyError, match="the event has no 'q'"):
        jump["q"]


def test_a_column_of_another_program_is_told():
    m = saltus.Builder("m")
    x, u = m.states("x", [0, 0]), m.controls("u", [1])
    A, B = np.array([[0, 1], [-1, -1]]), np.array([[0], [1.0]])
    with pytest.raises(saltus.ModelError, match=r"write B\[:, 0\]\*u"):
        m.rate(x, A @ x + B * u[0])
    m.rate(x, A @ x + B @ u)
    assert m.simulate(until=1).final["x"][0] > 0


def test_functions_of_numpy_take_expressions_of_no_axis():
    m = saltus.Builder("m")
    z = m.state("z", 0)
    assert str(np.clip(3 * z, -1, 1)) == "min(max(3*z,-1),1)"
    assert str(np.where(z > 0, 1, 2)) == "if(z>0,1,2)"
    assert texts(np.where(z > 0, saltus.array([z, 1]), 2)) == ["if(z>0,z,2)", "if(z>0,1,2)"]
    assert texts(np.stack([z, 2 * z])) == ["z", "2*z"] and np.ndim(z) == 0


@pytest.mark.parametrize("name, arguments, written", [
    ("gradient", (), "the quotients: (x[2:] - x[:-2])/(2*h)"),
    ("trapezoid", (), 'an integral is a state: z = m.state("z", 0), m.rate(z, …)'),
    ("interp", ([0, 1], [0, 2]), 'road = m.table("road", x=[0, 1], y=[0, 2]), then road(x)'),
    ("round", (), "saltus.floor(x + 0.5), of times only"),
    ("around", (2,), "saltus.floor(x + 0.5), of times only"),
    ("rint", (), "saltus.floor(x + 0.5)"),
    ("ceil", (), "-saltus.floor(-x)"),
    ("trunc", (), "saltus.floor(x)"),
    ("cbrt", (), "saltus.sign(x)*abs(x)**(1/3)"),
    ("expm1", (), "saltus.exp(x) - 1"),
    ("log1p", (), "saltus.log(1 + x)"),
    ("log2", (), "saltus.log(x)/saltus.log(2)"),
    ("digitize", ([0, 1],), "saltus.if_(x > 1, a, saltus.if_(x > 0, b, c))"),
    ("isnan", (), "a run ends where a value is no finite number"),
    ("isclose", (1,), "a condition of both sides"),
    ("spacing", (), "functions of the language"),
])
def test_functions_of_numpy_that_expressions_have_not_say_what_to_write(name, arguments, written):
    m = saltus.Builder("m")
    x = m.state("x", 1)
    for operand in x, saltus.array([x, 2 * x]):
        with pytest.raises(saltus.ModelError) as refused:
            getattr(np, name)(operand, *arguments)
        assert f"numpy.{name} is no function of expressions\n  write " in str(refused.value)
        assert written in str(refused.value)


def test_what_numpy_refuses_of_other_operands_is_its_own_to_say():
    m = saltus.Builder("m")
    X = saltus.array(m.states("x", [1, 2]))
    with pytest.raises(ValueError, match="broadcast"):
        np.add(X, [1, 2, 3])
    with pytest.raises(saltus.ModelError, match="numpy.inv is no function of expressions\n  write the formula"):
        np.linalg.inv(saltus.array([[X[0], 1], [1, X[1]]]))
    assert str(np.max(X)) == "max(x1,x2)"

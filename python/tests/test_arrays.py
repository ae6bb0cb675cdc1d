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
    for made in (lambda: np.array([X[0], X[1]]) > 0, lambda: np.maximum(X[0], 0), lambda: np.sign(np.array([X[0]]))):
        with pytest.raises(saltus.ModelError, match=r"saltus.array\(\[x, v\]\) > 0"):
            made()


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

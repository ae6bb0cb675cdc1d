"""Functions of Taylor series by their differential equations; plain numbers go to mpmath."""

import mpmath
from mpmath import mpf
from taylor_events import Series


def exp(x):
    if not isinstance(x, Series):
        return mpmath.exp(x)
    result = Series([mpmath.exp(x[0])])
    result.rule = lambda k: sum((i * x[i] * result.c[k - i] for i in range(1, k + 1)), mpf(0)) / k
    return result


def sin_and_cos(x):
    sine, cosine = Series([mpmath.sin(x[0])]), Series([mpmath.cos(x[0])])
    sine.rule = lambda k: sum((i * x[i] * cosine[k - i] for i in range(1, k + 1)), mpf(0)) / k
    cosine.rule = lambda k: -sum((i * x[i] * sine[k - i] for i in range(1, k + 1)), mpf(0)) / k
    return sine, cosine


def sin(x):
    return sin_and_cos(x)[0] if isinstance(x, Series) else mpmath.sin(x)


def cos(x):
    return sin_and_cos(x)[1] if isinstance(x, Series) else mpmath.cos(x)


def sqrt(x):
    if not isinstance(x, Series):
        return mpmath.sqrt(x)
    root = Series([mpmath.sqrt(x[0])])
    root.rule = lambda k: (x[k] - mpmath.fdot(root.c[1:k], root.c[k - 1 : 0 : -1])) / (2 * root.c[0])
    return root

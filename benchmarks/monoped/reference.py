"""Values of the monoped's reference at the ends of N intervals, as a table for [[optimize.least_squares]]."""

KNOTS = [
    (0.0, [0.0, 0.4, 0, 0, 0, 0, 0, 0]),
    (0.25, [0.75, 0.6, 0, 0, 1, 0, 0, 0]),
    (0.5, [1.5, 0.4, 0, 0, 1, 0, 0, 0]),
    (0.75, [2.25, 0.6, 0, 0, 1, 0, 0, 0]),
    (1.0, [3.0, 0.4, 0, 0, 0, 0, 0, 0]),
]
NAMES = ["q_x", "q_z", "phi_h", "phi_k", "v_x", "v_z", "w_h", "w_k"]


def basis(s):
    """Of cubic splines through five knots that are smooth at the second and the fourth one (not-a-knot)."""
    return [1.0, s, s**2, s**3, max(s - 0.5, 0.0) ** 3]


def solve(matrix, right):
    """Elimination with pivots."""
    n = len(right)
    rows = [list(row) + [value] for row, value in zip(matrix, right)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k])]
    solution = [0.0] * n
    for k in reversed(range(n)):
        known = sum(rows[k][j] * solution[j] for j in range(k + 1, n))
        solution[k] = (rows[k][n] - known) / rows[k][k]
    return solution


def spline(goal):
    """The eight columns as functions of s in [0, 1]; goal: distance in metres."""
    matrix = [basis(s) for s, _ in KNOTS]
    columns = []
    for i in range(len(NAMES)):
        scale = goal / 3.0 if NAMES[i] in ("q_x", "v_x") else 1.0
        columns.append(solve(matrix, [scale * values[i] for _, values in KNOTS]))
    return lambda s: [sum(c * b for c, b in zip(column, basis(s))) for column in columns]


def table(intervals, goal=3.0):
    """Text of the table: a row for the end of every interval."""
    values = spline(goal)
    lines = [",".join(NAMES)]
    for k in range(1, intervals + 1):
        lines.append(",".join(repr(x) for x in values(k / intervals)))
    return "\n".join(lines) + "\n"

"""The same study by SciPy: stick-slip with its modes and their ends hard-coded, a restart behind each."""

from scipy.integrate import solve_ivp


def run(belt, until, rtol, atol):
    """The state at the end, and the number of events."""
    mode = "slower"

    def field(_t, x):
        if mode == "stuck":
            return x[1], 0.0
        return x[1], -x[0] + (1 / (1 + belt - x[1]) if mode == "slower" else -1 / (1 - belt + x[1]))

    def guard(_t, x):
        if mode == "stuck":
            return 1 - x[0]
        return belt - x[1] if mode == "slower" else x[1] - belt

    guard.terminal, guard.direction = True, -1
    t, x, events = 0.0, (0.04, -0.01), 0
    while t < until:
        solution = solve_ivp(field, (t, until), x, "RK45", events=guard, rtol=rtol, atol=atol)
        t, x = solution.t[-1], solution.y[:, -1]
        if solution.status != 1:
            break
        events += 1
        if mode == "stuck":
            mode, x = "slower", (1.0, belt)
        else:
            mode, x = ("stuck" if abs(x[0]) < 1 else "faster" if mode == "slower" else "slower"), (x[0], belt)
    return x[0], x[1], events

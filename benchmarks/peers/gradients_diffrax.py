"""Runner of gradients.py: diffrax, as a user writes it. Jumps have no form there but a loop of the user's: no row."""

import json
import time

import diffrax
import jax
import jax.numpy as jnp

jax.config.update("jax_enable_x64", True)


def end(rate, start, parameter, until, component):
    solution = diffrax.diffeqsolve(diffrax.ODETerm(rate), diffrax.Tsit5(), 0.0, until, 0.01, jnp.array(start), args=parameter, max_steps=100_000,
                                   stepsize_controller=diffrax.PIDController(rtol=1e-8, atol=1e-8))
    return solution.ys[-1][component]


PROBLEMS = {
    "crossing": (lambda v: end(lambda t, y, p: 2 - jnp.sign(y), [v], None, 2.0, 0), -1.0),
    "arrival": (lambda v: end(lambda t, y, p: jnp.array([-jnp.sign(y[0]), jnp.abs(y[0])]), [v, 0.0], None, 2.0, 1), 1.0),
    "exit": (lambda v: end(lambda t, y, p: p * t - jnp.sign(y), [0.0], v, 2.0, 0), 1.0),
    "brake": (lambda v: end(lambda t, y, p: jnp.array([y[1], -0.5 * jnp.sign(y[1])]), [0.0, v], None, 6.0, 0), 2.0),
    "relay": (lambda v: end(lambda t, y, p: jnp.array([-jnp.sign(y[1]), y[0]]), [v, 0.0], None, 3.0, 0), 1.0),
}

for name, (function, at) in PROBLEMS.items():
    begin = time.process_time()
    try:
        value = float(jax.grad(function)(at))
        print(json.dumps({"problem": name, "value": value, "seconds": time.process_time() - begin}), flush=True)
    except Exception as error:  # noqa: BLE001: whatever the peer raises is its answer
        print(json.dumps({"problem": name, "status": f"stopped: {type(error).__name__}", "seconds": time.process_time() - begin}), flush=True)

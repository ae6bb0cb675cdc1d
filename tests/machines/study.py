"""One sweep by the workers of a library: study.py LIBRARY WHAT OUT.npz

LIBRARY: loky, dask, ray, mpi4py (by `mpiexec -n 3 python -m mpi4py.futures study.py …`), or none, for one process.
WHAT: plain; kill, where one of two workers is killed on the way; folder, which writes into OUT.npz.runs as well.
"""

import contextlib
import os
import signal
import sys
import threading
import time

import numpy as np

import saltus

BELTS = np.linspace(0.05, 0.3, 48)


@contextlib.contextmanager
def loky_pool():
    import loky

    yield loky.get_reusable_executor(2)
    loky.get_reusable_executor().shutdown()


@contextlib.contextmanager
def dask_pool():
    from dask.distributed import Client

    with Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client:
        yield client.get_executor()


@contextlib.contextmanager
def ray_pool():
    import ray

    class Pool:
        _max_workers = 2

        def submit(self, function, *arguments):
            return ray.remote(function).remote(*arguments).future()

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    yield Pool()
    ray.shutdown()


@contextlib.contextmanager
def mpi_pool():
    from mpi4py.futures import MPIPoolExecutor

    with MPIPoolExecutor(2) as pool:
        yield pool


POOLS = {"loky": loky_pool, "dask": dask_pool, "ray": ray_pool, "mpi4py": mpi_pool, "none": contextlib.nullcontext}


def own_id():
    return os.getpid()


def kill_a_worker(pool):
    """One of the two, which has a share then."""
    pid = pool.submit(own_id).result()

    def kill():
        time.sleep(0.3)
        os.kill(pid, signal.SIGKILL)

    threading.Thread(target=kill, daemon=True).start()


def main(library, what, out):
    m = saltus.catalogue("stick-slip")
    how = {"belt": BELTS, "until": 1500, "keep": "events" if what == "plain" else "final", "rtol": 1e-9}
    with POOLS[library]() as pool:
        if what == "kill":
            kill_a_worker(pool)
        if what == "folder":
            s = m.sweep(**how, executor=pool, resume=out + ".runs")
        else:
            s = m.sweep(**how, executor=pool)
        s.save(out)


if __name__ == "__main__":
    main(*sys.argv[1:])

"""The package in its process: libraries, threads, signals."""

import concurrent.futures
import json
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import saltus


def run_python(code):
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("order", ["casadi, saltus", "saltus, casadi"])
def test_casadi_is_there_once_whoever_comes_first(order):
    out = run_python(f"""
        import {order}
        x = casadi.SX.sym("x")
        solver = casadi.nlpsol("s", "ipopt", {{"x": x, "f": (x - 1) ** 2}}, {{"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": 0}})
        print(float(solver(x0=0)["x"]))
        print(saltus.catalogue("stick-slip").simulate(until=5).status)
        print(saltus.catalogue("stick-slip").simulate(until=2, method="fesd", step_equilibration="none", steps=5).status)
        print(float(solver(x0=3)["x"]))
        maps = open("/proc/self/maps").read()
        for name in ("libcasadi.so", "libipopt.so", "libhighs.so"):
            print(name, len({{line.split()[-1] for line in maps.splitlines() if name in line}}))
    """).split("\n")
    assert abs(float(out[0]) - 1) < 1e-6
    assert out[1:3] == ["completed", "completed"]
    assert abs(float(out[3]) - 1) < 1e-6
    assert out[4:7] == ["libcasadi.so 1", "libipopt.so 1", "libhighs.so 1"]


def test_a_file_called_casadi_is_not_the_package(tmp_path):
    """What lies beside a notebook under this name comes first; that is said, not that a library is missing."""
    (tmp_path / "casadi.py").write_text("")
    done = subprocess.run([sys.executable, "-c", "import saltus"], cwd=tmp_path, capture_output=True, text=True)
    assert "is a file of yours called casadi" in done.stderr.splitlines()[-1]


def test_another_casadi_is_refused_in_one_sentence():
    out = run_python("""
        import importlib.machinery, importlib.util, pathlib, tempfile
        site = pathlib.Path(tempfile.mkdtemp())
        (site / "casadi").mkdir()
        (site / "casadi-3.6.7.dist-info").mkdir()
        spec = importlib.machinery.ModuleSpec("casadi", None, origin=str(site / "casadi/__init__.py"))
        importlib.util.find_spec = lambda name: spec
        try:
            import saltus
        except ImportError as error:
            print(error)
    """)
    assert out.startswith("saltus was built with casadi 3.8 and found casadi 3.6.7: pip install")
    assert out.count("\n") == 1


def test_many_runs_in_four_threads_equal_those_in_one():
    """Kernels of all of them are made and dropped while others run."""
    names = ["stick-slip", "bouncing-ball", "relay-feedback", "two-belts"]
    models = {name: saltus.catalogue(name) for name in names}
    tasks = [(names[i % 4], 1.0 + 0.01 * (i // 4)) for i in range(1000)]

    def run(task):
        name, until = task
        r = models[name].simulate(until=until)
        return r.x.tobytes(), [e.t for e in r.events]

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        found = list(pool.map(run, tasks))
    assert found == [run(task) for task in tasks]


LONG = """
[model]
name = "long"
[states]
x = 1
v = 0
[dynamics]
x = "v"
v = "-x - 0.01*sign(v - cos(3*t))"
"""


def test_control_c():
    # Python does not look at the signal where the shell has it ignored, as of what runs in its background.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    model = saltus.Model.from_text(LONG)
    sent = []

    def interrupt():
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    threading.Timer(0.3, interrupt).start()
    with pytest.raises(KeyboardInterrupt) as stopped:
        model.simulate(until=1e7, max_steps=10**9, max_events=10**9)
    assert time.perf_counter() - sent[0] < 5  # some 0.05 s; a busy machine takes longer
    r = stopped.value.result
    assert r.status == "stopped_by_user"
    assert 0 < r.status.time_reached < 1e7
    assert r.t[-1] == r.status.time_reached
    signal.signal(signal.SIGINT, before)


def test_a_second_control_c_keeps_what_was_found(block):
    sent = []

    def stop(number, frame):
        if not sent:
            threading.Timer(0.003, os.kill, (os.getpid(), signal.SIGINT)).start()
        sent.append(time.perf_counter())
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, stop)
    threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
    found = []
    try:
        try:
            block.optimize(control_intervals=300)
        except KeyboardInterrupt as stopped:
            found.append(stopped)
        time.sleep(1)
    except KeyboardInterrupt:
        pass
    signal.signal(signal.SIGINT, before)
    assert len(sent) == 2 and found[0].result.status == "stopped_by_user"


@pytest.mark.parametrize("long_run", [
    lambda: saltus.Model.from_text(LONG).simulate(until=30000, points=2, max_events=10**9),
    lambda: saltus.Model.from_text(LONG).simulate(until=4000, method="fesd", steps=8000, max_events=10**9),
    lambda: saltus.catalogue("slide-and-hide").optimize(),
], ids=["event", "fesd", "optimize"])
def test_other_threads_run_meanwhile(long_run):
    ticks = 0
    done = threading.Event()

    def run():
        long_run()
        done.set()

    threading.Thread(target=run).start()
    while not done.is_set():
        ticks += 1
        time.sleep(0.001)
    assert ticks >= 20


def test_problems_of_threads_equal_those_of_one():
    """Programs with complementarities and elements are made and dropped while others are solved."""
    tasks = [
        lambda: saltus.catalogue("slide-and-hide").optimize().x.tobytes(),
        lambda: saltus.catalogue("stick-slip").simulate(until=5, method="fesd").x.tobytes(),
        lambda: saltus.catalogue("stick-slip").simulate(until=2, method="fesd", step_equilibration="none",
                                                        steps=5).x.tobytes(),
    ] * 3
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda task: task(), tasks))
    assert found == [task() for task in tasks[:3]] * 3


def test_who_stops_a_comparison_does_not_wait_for_another_run():
    """Stopped in its second run: the reference is not run once more for its state there."""
    model = saltus.Model.from_text(LONG)
    heard = {"t": 0.0, "second": False}

    def tell(t, first, until, steps, events):
        heard["second"] = heard["second"] or t < heard["t"]
        heard["t"] = t
        if heard["second"] and t > until / 3:
            raise KeyboardInterrupt

    many = str(10**9)
    options = [("simulate.until", "30000", "u"), ("simulate.max_events", many, "e"), ("simulate.max_steps", many, "s")]
    with pytest.raises(KeyboardInterrupt) as stopped:
        model._core.compare([], options, tell, [])
    reference, second, *_ = json.loads(stopped.value.result.json(False))["comparison"]["runs"]
    assert reference["x"] == []
    assert second["status"]["termination"] == "stopped_by_user"


def test_progress_and_what_it_raises():
    model = saltus.Model.from_text(LONG)
    heard = []

    def tell(*what):
        heard.append(what)
        if len(heard) == 3:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough") as stopped:
        model._core.simulate([], [("simulate.until", "1e7", "until"), ("simulate.max_events", "1000000000", "e"),
                                  ("simulate.max_steps", "1000000000", "s")], tell, [])
    assert len(heard) == 3
    times = [what[0] for what in heard]
    assert times == sorted(times)
    assert saltus._core.Run is type(stopped.value.result)


class Heard:
    def __init__(self, most=None):
        self.phases, self.steps, self.most = [], 0, most

    def __call__(self, *step):
        self.steps += 1

    def prepare(self, phase, done, all):
        assert 0 <= done <= all
        self.phases.append(phase)
        if len(self.phases) == self.most:
            raise RuntimeError("enough")


def dense_network(n):
    b = saltus.Builder("dense")
    x = b.states("x", np.ones(n))
    b.rate(x, np.random.default_rng(0).normal(size=(n, n)) @ np.maximum(x - 0.5, 0) - 9 * x)
    return b.model()


def test_what_is_prepared_is_told_and_can_be_stopped():
    model = dense_network(150)
    options = [("simulate.until", "1e-6", "until")]
    stopping = Heard(most=1)
    with pytest.raises(RuntimeError, match="enough") as stopped:
        model._core.simulate([], options, stopping, [])
    assert stopped.value.result is None
    hearing = Heard()
    assert model._core.simulate([], options, hearing, []).termination == "completed"
    assert hearing.phases and set(hearing.phases) <= {
        "reading the model", "finding what jumps", "writing right-hand sides", "compiling the model"
    }  # fmt: skip


def test_what_is_compiled_after_the_first_step_does_not_lose_the_run():
    class Interrupting(Heard):
        def __call__(self, *step):
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough") as stopped:
        saltus.Model.from_text(LONG)._core.simulate(
            [], [("simulate.until", "1e7", "until"), ("simulate.max_events", "1000000000", "e"),
                 ("simulate.max_steps", "1000000000", "s")], Interrupting(), []
        )  # fmt: skip
    assert type(stopped.value.result) is saltus._core.Run


ENDLESS_SWEEP = """
    import contextlib, os, signal, sys, types
    import concurrent.futures as futures
    import multiprocessing
    import numpy as np
    import saltus

    class Bar:  # in the place of tqdm: the first runs that are done are followed by a Ctrl-C
        n, total = 0, None

        def update(self, more):
            self.n += more
            if self.n > 0:
                os.kill(os.getpid(), signal.SIGINT)

    def tqdm(**how):
        return contextlib.nullcontext(Bar())

    if __name__ == "__main__":
        m = saltus.catalogue("stick-slip")
        signal.signal(signal.SIGINT, signal.default_int_handler)  # whoever runs the tests may ignore it
        make = {"processes": lambda: futures.ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")),
                "threads": lambda: futures.ThreadPoolExecutor(2)}[sys.argv[1]]
        with make() as pool:
            m.sweep(belt=[0.1, 0.2], until=1, executor=pool)
            sys.modules["tqdm"], sys.modules["tqdm.auto"] = types.ModuleType("tqdm"), types.SimpleNamespace(tqdm=tqdm)
            try:
                m.sweep(belt=np.linspace(0.05, 0.3, 100_000), until=1000, executor=pool, progress=True)
            except KeyboardInterrupt as stopped:
                s = stopped.result
        assert 0 < len(s) < 100_000 and len(s["q"]) == len(s), len(s)
        assert set(s["status"]) <= {"completed", "stopped_by_user"}, repr(s)
        belts = np.linspace(0.05, 0.3, 100_000)
        assert s["belt"].tolist() == belts[s["run"] - 1].tolist()
        assert s.results[0].final["q"] == s["q"][0]
        print(s)
"""


@pytest.mark.parametrize("kind", ["processes", "threads"])
def test_who_stops_a_sweep_by_an_executor_gets_what_there_is(tmp_path, kind):
    (tmp_path / "study.py").write_text(textwrap.dedent(ENDLESS_SWEEP))
    done = subprocess.run([sys.executable, "study.py", kind], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("<saltus.Sweep of ")


def test_progress_of_a_sweep(capsys, monkeypatch):
    m = saltus.catalogue("stick-slip")
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    belts = [0.1 + 1e-6 * i for i in range(3000)]
    begin = time.monotonic()
    m.sweep(belt=belts, until=1, progress=True, jobs=1)
    writes = capsys.readouterr().err.split("\r")
    assert writes[-1] == "stick-slip: 3000 of 3000 runs\n"
    assert len(writes) <= 3 + 10 * (time.monotonic() - begin)
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        m.sweep(belt=[0.1, 0.2], until=1, progress=True, executor=pool)
    assert capsys.readouterr().err.endswith("stick-slip: 2 of 2 runs\n")


def test_progress_of_a_sweep_by_tqdm(bars):
    saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2, 0.3], until=1, progress=True)
    assert [(bar.n, bar.total) for bar in bars] == [(3, 3)]

"""Sweeps whose runs have different switching functions: one table, however its parts come together."""

import numpy as np
import pytest

import saltus
from test_sweeps import Inline, run_tool, shares


@pytest.fixture()
def gain(tmp_path):
    """A relay whose gain may be 0: then there is nothing that switches."""
    path = tmp_path / "gain.toml"
    path.write_text('[model]\nname = "gain"\n[parameters]\nk = 1\n[states]\nx = 1\n[dynamics]\nx = "-k*sign(x) - 0.1*sign(x - 0.5)"\n'
                    '[simulate]\nuntil = 0.4\noutput = { points = 3 }\n')
    return path


@pytest.mark.parametrize("gains", [[0, 1, 2], [1, 0, 2]])
def test_runs_may_have_different_switching_functions(gain, tool, tmp_path, gains):
    """Columns are those of all runs; of a run without the function its mode is a gap."""
    m = saltus.Model(gain)
    s = m.sweep(k=gains, keep="trajectory")
    assert {name for name in s.table if name.startswith("mode(")} == {"mode(x)", "mode(x-0.5)"}
    for i, k in enumerate(gains):
        alone, rows = m.simulate(set={"k": k}), s["run"] == i + 1
        assert s["x"][rows].tolist() == alone["x"].tolist()
        assert s["mode(x-0.5)"][rows].tolist() == alone["mode(x-0.5)"].tolist()
        here = s["mode(x)"][rows]
        assert np.isnan(here).all() if k == 0 else here.tolist() == alone["mode(x)"].tolist()
    for keep in ("final", "events"):
        assert len(m.sweep(k=gains, keep=keep)["run"]) >= 3
    sweep = ["gain.toml", "--over", f"k={','.join(map(str, gains))}", "--keep", "trajectory"]
    run_tool(tool, tmp_path, *sweep, "--out", "whole.csv")
    s.save(tmp_path / "python.csv")
    assert (tmp_path / "whole.csv").read_text() == (tmp_path / "python.csv").read_text()


@pytest.mark.parametrize("gains", [[0, 1, 2], [1, 0, 2]])
def test_shares_may_have_different_switching_functions(gain, tool, tmp_path, gains):
    """Joined, by an executor and in a folder: the table of one process, up to the order of its columns."""
    m = saltus.Model(gain)
    whole = m.sweep(k=gains, keep="trajectory")
    tables = [m.sweep(k=gains, keep="trajectory", executor=Inline()).table,
              m.sweep(k=gains, keep="trajectory", resume=tmp_path / "python").table]
    parts = list(m.sweep(k=gains, keep="trajectory", resume=tmp_path / "python").parts())
    assert len(parts) == 3 and all(set(part) == set(whole.table) for part in parts)
    sweep = ["gain.toml", "--over", f"k={','.join(map(str, gains))}", "--keep", "trajectory"]
    files = shares(tool, tmp_path, 3, *sweep)
    run_tool(tool, tmp_path, "--join", *files, "--out", "joined.csv")
    run_tool(tool, tmp_path, *sweep, "--resume", "runs", "--out", "resumed.csv")
    tables += [np.genfromtxt(tmp_path / file, delimiter=",", names=True, deletechars="", dtype=None, encoding=None)
               for file in ("joined.csv", "resumed.csv")]
    for table in tables:
        names = table.dtype.names if isinstance(table, np.ndarray) else list(table)
        assert set(names) == set(whole.table)
        for name in whole.table:
            if whole[name].dtype.kind == "U":
                assert table[name].tolist() == whole[name].tolist()
            else:
                np.testing.assert_array_equal(np.asarray(table[name], dtype=float), whole[name].astype(float), name)

"""Foreign problems with complementarities."""

import json
import subprocess

import numpy as np
import pytest

import saltus


@pytest.fixture
def problem(source):
    return source / "examples" / "mpcc" / "friction.nl"


def test_it_is_what_the_tool_says(problem, tool, tmp_path):
    p = saltus.mpcc(problem)
    assert p.done and p.status == "completed"
    assert p.objective == pytest.approx(40/11, abs=1e-8)
    out = tmp_path / "p.json"
    subprocess.run([tool, "mpcc", str(problem), "--quiet", "--out", str(out)], check=True)
    stored = json.loads(out.read_text())
    assert stored["x"] == p.x.tolist()
    assert stored["objective"] == p.objective
    p.save(tmp_path / "q.json")
    assert json.loads((tmp_path / "q.json").read_text())["certificate"] == stored["certificate"]
    assert "completed" in str(p) and "font-family:monospace" in p._repr_html_()
    again = saltus.mpcc(problem, start=p, first="branch")
    assert again.x == pytest.approx(p.x, abs=1e-8)


def test_what_is_wrong_is_said(problem, tmp_path):
    for call, said in [
        (lambda: saltus.mpcc(tmp_path / "no.nl"), "no.nl"),
        (lambda: saltus.mpcc(problem, tolerance=-1), "tolerance=-1"),
        (lambda: saltus.mpcc(problem, method="schol"), "scholtes"),
        (lambda: saltus.mpcc(problem, tolerence=1e-8), "tolerance"),
        (lambda: saltus.mpcc(problem, time_limit=0), "time_limit=0"),
        (lambda: saltus.mpcc(problem, start=[1, 2, 3, 4, 5, 6, 7, 8, 9]), "9"),
        (lambda: saltus.mpcc(problem, start=[np.nan]), "finite"),
    ]:
        with pytest.raises(saltus.ModelError) as refused:
            call()
        assert said in str(refused.value)


def test_every_problem_is_told(problem, capsys, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    p = saltus.mpcc(problem, progress=True)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) >= 1 and len(p.homotopy) >= 1


def test_a_problem_of_casadi_as_the_page_writes_it(source, tmp_path, monkeypatch):
    pytest.importorskip("casadi")
    page = (source / "docs" / "foreign-mpcc.md").read_text(encoding="utf-8")
    block = page.partition("### From CasADi")[2].partition("```python\n")[2].partition("```")[0]
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "foreign-mpcc.md", "exec"), {})
    p = saltus.mpcc("two.json")
    assert p.done and p.x == pytest.approx([0, 2], abs=1e-8) and p.objective == pytest.approx(1)

"""Every example of a docstring."""

import doctest
import importlib
import pkgutil
import re

import pytest

import saltus

MODULES = [module.name for module in pkgutil.iter_modules(saltus.__path__) if module.name not in ("_core", "__main__")]


@pytest.mark.parametrize("name", MODULES)
def test_examples(name):
    module = importlib.import_module(f"saltus.{name}")
    assert doctest.testmod(module, extraglobs={"saltus": saltus}).failed == 0


def test_the_package_itself():
    tried = doctest.testmod(saltus)
    assert tried.attempted > 0
    assert tried.failed == 0


def test_the_blocks_of_the_page_run(source, tmp_path, monkeypatch):
    """All of docs/python.md, one after the other, as a person would paste them."""
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (source / "docs" / "python.md").read_text(), re.DOTALL)
    assert len(blocks) >= 3
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)

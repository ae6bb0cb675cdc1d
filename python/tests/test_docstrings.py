"""Every example of a docstring."""

import doctest
import functools
import importlib
import inspect
import pkgutil
import re

import numpy as np
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


def public_objects():
    """(name, docstring) of all public functions, classes, methods and properties of the package."""
    found = {}
    for name in saltus.__all__:
        value = getattr(saltus, name)
        if not inspect.isclass(value):
            if callable(value):
                found[name] = value.__doc__
            continue
        found[name] = value.__doc__
        if value.__module__ == "saltus._core":
            continue  # its attributes are told by the class
        for kind in value.__mro__:
            if not kind.__module__.startswith("saltus."):
                continue
            for member, what in vars(kind).items():
                if member.startswith("_") and member not in ("__call__", "__getitem__"):
                    continue
                if isinstance(what, functools.cached_property):
                    what = what.func
                elif isinstance(what, property):
                    what = what.fget
                elif isinstance(what, (classmethod, staticmethod)):
                    what = what.__func__
                if inspect.isfunction(what):
                    found[f"{name}.{member}"] = what.__doc__
    return found


@pytest.mark.parametrize("name", public_objects())
def test_every_public_name_has_an_example_that_runs(name):
    text = public_objects()[name]
    assert text, "no docstring"
    examples = doctest.DocTestParser().get_doctest(text, {"saltus": saltus, "np": np}, name, None, None)
    assert examples.examples, "no example"
    assert doctest.DocTestRunner().run(examples).failed == 0


def test_attributes_of_events_are_told():
    for kind in (saltus.Event, saltus.Alternative, saltus.Intersection):
        for member in vars(kind):
            if not member.startswith("_"):
                stem = member.replace("_before", "").replace("_after", "")
                assert f"``{stem}" in kind.__doc__, member


def test_the_blocks_of_the_page_run(source, tmp_path, monkeypatch):
    """All of docs/python.md, one after the other, as a person would paste them."""
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (source / "docs" / "python.md").read_text(), re.DOTALL)
    assert len(blocks) >= 3
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)

"""The modules of the package lie in layers: each knows those below it, and none knows itself by way of others."""

import ast
import graphlib

#: From below. A module may import those of lower layers, and of its own where that makes no circle.
LAYERS = {
    "ground": "_core _build _libraries _spelling _progress _signature _keywords",
    "errors": "_errors",
    "expressions": "_array _sums _expression _functions _casadi _sympy",
    "words": "_names _outcome _samples _settings _entries",
    "recorded": "_columns _events _facts _recorded",
    "pictures": "_shape _data _plot _card _sweep_plot",
    "results": "_result _difference _mpcc",
    "sweeps": "_tasks _sweep _sweep_folder _shares _stored_sweep _starts",
    "models": "_model _catalogue",
    "builder": "_statement _structure _builder",
}


def imports_of(tree):
    """(name of a module of the package, whether the import stands at the top of the file) of all imports."""
    top = {id(node) for node in tree.body}
    for guard in tree.body:
        if isinstance(guard, ast.If):  # if typing.TYPE_CHECKING
            top |= {id(node) for node in guard.body}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level in (1, 2):
            for name in [node.module] if node.module else [alias.name for alias in node.names]:
                yield name.split(".")[-1], id(node) in top


def package(source):
    files = sorted((source / "python" / "saltus").rglob("*.py"))
    assert len(files) > 30
    return {file.stem: list(imports_of(ast.parse(file.read_text()))) for file in files if file.stem[:2] != "__"}


def test_every_module_has_its_layer_and_knows_lower_ones_only(source):
    rank = {module: i for i, modules in enumerate(LAYERS.values()) for module in modules.split()}
    found = package(source)
    assert set(found) | {"_core", "_build"} == set(rank)
    upward = [f"{module} imports {name}" for module, names in found.items() for name, _ in names if rank[name] > rank[module]]
    assert upward == []


def test_no_module_knows_itself_by_way_of_others(source):
    graph = {module: {name for name, _ in names} for module, names in package(source).items()}
    assert len(list(graphlib.TopologicalSorter(graph).static_order())) >= len(graph)


def test_imports_stand_at_the_top(source):
    """One in a function would hide a circle."""
    hidden = [f"{module}: {name}" for module, names in package(source).items() for name, at_top in names if not at_top]
    assert hidden == []

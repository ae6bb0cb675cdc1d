"""Pages made from the tables of the source: commands, functions, keys of model files, Python, C++; and their list."""

import json
import re
import subprocess
import sys
from pathlib import Path


def commands_of(tool):
    text = subprocess.run([tool, "help"], capture_output=True, text=True, check=True).stdout
    listed = text.partition("Subcommands:\n")[2].partition("\n\n")[0]
    return [line.split()[0] for line in listed.splitlines() if line.startswith("  ") and not line.startswith("   ")]


def command_page(tool):
    rows = ["# Every command", "", "From the tool itself: `saltus help COMMAND`.", ""]
    for command in commands_of(tool):
        text = subprocess.run([tool, "help", command], capture_output=True, text=True, check=True).stdout
        rows += [f"## saltus {command}", "", "```text", text.rstrip(), "```", ""]
    return "\n".join(rows)


FUNCTIONS = {
    "step": "switching", "sign": "switching", "if": "switching", "abs": "kink", "max": "kink", "min": "kink",
    "floor": "of the time", "mod": "of the time",
}


def function_page(root):
    table = (root / "src/saltus/expression/functions.cpp").read_text().partition("table{")[2].partition("};")[0]
    found = re.findall(r'\{"(\w+)", (\d)\}', table)
    rows = ["# Functions of the language", "", "From the table of the parser. What the kinds mean: [the model file](../model-file.md#expressions).", "",
            "| function | arguments | kind |", "|---|---|---|"]
    return "\n".join(rows + [f"| `{name}` | {count} | {FUNCTIONS.get(name, 'smooth')} |" for name, count in found]) + "\n"


def kind_of(schema, whole):
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return name.replace("_", " ")
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    if "anyOf" in schema:
        return " or ".join(dict.fromkeys(kind_of(part, whole) for part in schema["anyOf"]))
    kind = schema.get("type", "")
    return {"array": "list", "object": "table", "boolean": "true, false"}.get(kind, str(kind))


def key_rows(name, schema, whole, rows):
    described = schema.get("items", schema) if schema.get("type") == "array" else schema
    for part in [described, *described.get("anyOf", [])]:
        for key, value in part.get("properties", {}).items():
            text = value.get("description", "").replace("|", "\\|")
            rows.append(f"| `{key}` | {kind_of(value, whole)} | {text} |")


def schema_page(tool):
    schema = json.loads(subprocess.run([tool, "schema"], capture_output=True, text=True, check=True).stdout)
    rows = ["# Every key of a model file", "", "From `saltus schema`, which editors read. What they do: [the model file](../model-file.md); "
            "keys of `[simulate]` and `[optimize]` with their defaults: [options](../options.md).", ""]
    for table, content in schema["properties"].items():
        if table in ("simulate", "optimize"):
            continue
        rows += [f"## {table}", "", content.get("description", "").capitalize() or "", ""]
        head = len(rows)
        rows += ["| key | value | meaning |", "|---|---|---|"]
        key_rows(table, content, schema, rows)
        if len(rows) == head + 2:
            del rows[head:]
    return "\n".join(rows) + "\n"


PYTHON = """# Python, every name

Read [Saltus in Python](../python.md) first.

```{eval-rst}
.. automodule:: saltus

.. autoclass:: saltus.Model
   :members:
   :special-members: __init__

.. autoclass:: saltus.Builder
   :members:
   :inherited-members:

.. autoclass:: saltus.Expression

.. autofunction:: saltus.array

.. autoclass:: saltus.Array

.. autoclass:: saltus.Result
   :members:
   :inherited-members:
   :special-members: __getitem__, __call__

.. autoclass:: saltus.Sweep
   :members:
   :special-members: __getitem__

.. autoclass:: saltus.Events
   :members:

.. autoclass:: saltus.Event

.. autoclass:: saltus.Alternative

.. autoclass:: saltus.Intersection

.. autoclass:: saltus.Final
   :members:
   :special-members: __getitem__

.. autoclass:: saltus.Status
   :members:

.. autoclass:: saltus.Sensitivities

.. autoexception:: saltus.ModelError
   :members:

.. autoexception:: saltus.Stopped

.. autoexception:: saltus.ModelWarning

.. autofunction:: saltus.catalogue

.. autofunction:: saltus.models

.. autofunction:: saltus.load

.. autofunction:: saltus.compare

.. autofunction:: saltus.order
```

## Functions of the language

```{eval-rst}
.. autofunction:: saltus.if_

.. autofunction:: saltus.step

.. autofunction:: saltus.sign

.. autofunction:: saltus.abs

.. autofunction:: saltus.max

.. autofunction:: saltus.min

.. autofunction:: saltus.floor

.. autofunction:: saltus.mod

.. autofunction:: saltus.sin

.. autofunction:: saltus.cos

.. autofunction:: saltus.tan

.. autofunction:: saltus.asin

.. autofunction:: saltus.acos

.. autofunction:: saltus.atan

.. autofunction:: saltus.atan2

.. autofunction:: saltus.sinh

.. autofunction:: saltus.cosh

.. autofunction:: saltus.tanh

.. autofunction:: saltus.exp

.. autofunction:: saltus.log

.. autofunction:: saltus.log10

.. autofunction:: saltus.sqrt

.. autofunction:: saltus.pow

.. autofunction:: saltus.hypot
```
"""

CPP_FILES = [
    ("Stating a model", ["model/builder.hpp", "model/recognition/condition.hpp", "model/build.hpp", "model/override.hpp", "model/decisions.hpp"]),
    ("Simulating it", ["pipeline/simulate.hpp", "pipeline/options/simulate_options.hpp", "pipeline/values_at.hpp", "pipeline/sweep.hpp",
                       "pipeline/compare.hpp", "pipeline/order.hpp", "base/symbolic_lock.hpp"]),
    ("Optimal control", ["model/optimal_control/ocp_builder.hpp", "model/ocp.hpp", "pipeline/optimal_control/optimize.hpp",
                         "pipeline/options/optimize_options.hpp", "result/optimization.hpp"]),
    ("What one gets", ["result/result.hpp", "result/continuous.hpp", "result/events.hpp", "result/status.hpp"]),
    ("Reading and writing", ["io/toml/toml_model.hpp", "io/json/json_result.hpp", "io/atomic_file.hpp"]),
    ("Errors", ["base/error.hpp"]),
]
CPP_SECTIONS = ("briefdescription detaileddescription func enum innerclass innernamespace typedef var "
                "public-type public-func public-static-func public-attrib")


def cpp_page(root):
    rows = ["# The C++ library", "", "`find_package(saltus)`, link `saltus::saltus`. A whole program: [start](../start.md#a-program-in-c); more: [inside a C++ program](../embedding.md). Here are the headers "
            "that a program includes first; every other header says in its comments what it does.", ""]
    for title, names in CPP_FILES:
        rows += [f"## {title}", ""]
        for name in names:
            if not (root / "src/saltus" / name).exists():
                sys.exit(f"the C++ reference names src/saltus/{name}, which is not there")
            rows += [f"### saltus/{name}", "", "```{eval-rst}", f".. doxygenfile:: {Path(name).name}", "   :project: saltus",
                     f"   :sections: {CPP_SECTIONS}", "```", ""]
    return "\n".join(rows)


def write(source, tool, root):
    """The pages in source/made."""
    made = source / "made"
    made.mkdir(exist_ok=True)
    (made / "commands.md").write_text(command_page(tool))
    (made / "functions.md").write_text(function_page(root))
    (made / "keys.md").write_text(schema_page(tool))
    (made / "python.md").write_text(PYTHON)
    (made / "cpp.md").write_text(cpp_page(root))


def write_index(source, with_cpp, quick):
    """The list of the generated pages that the index includes."""
    names = ["commands", "keys", "functions", "python", "cpp"]
    if not with_cpp:
        (source / "made/cpp.md").write_text("# The C++ library\n\nNot made in a quick build, or without Doxygen.\n")
    lines = "\n".join(f"made/{name}" for name in names)
    page = source / "reference.md"
    page.write_text(page.read_text().replace("% made", lines))
    if quick:
        (source / "gallery").mkdir(exist_ok=True)
        (source / "gallery/index.md").write_text("# Gallery\n\nNot made in a quick build.\n")

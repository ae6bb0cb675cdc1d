"""A small source tree that every check accepts, for the tests of the checks to spoil."""

import tempfile
import tomllib
from pathlib import Path

TABLE = tomllib.loads((Path(__file__).parent / "dependencies.toml").read_text(encoding="utf-8"))
GOOD = {
    "CMakeLists.txt": "saltus_module(base)\nsaltus_module(expression LINKS base)\n"
    "saltus_module(model HEAVY_HEADERS LINKS base expression PUBLIC_LIBRARIES casadi::casadi)\n"
    "saltus_module(evaluation LINKS base model ode\n  PRIVATE_LIBRARIES casadi::casadi)\nsaltus_module(ode LINKS base)\n",
    "src/saltus/base/error.hpp": "#pragma once\n",
    "src/saltus/ode/stepper.cpp": '#include "saltus/ode/stepper.hpp"\n#include "saltus/base/error.hpp"\n',
    "src/saltus/model/system.hpp": '#include <casadi/core/sx.hpp>\n#include "saltus/expression/parser.hpp"\n',
    "src/saltus/evaluation/kernel.cpp": "#include <casadi/core/sx.hpp>\n",
    "src/saltus/io/reader.cpp": "#include <toml++/toml.h>\n#include <iostream>\n",
    "src/saltus/io/hidden_internal.hpp": "#include <nlohmann/json.hpp>\n",
    "src/saltus/cli/main.cpp": '#include <CLI/CLI.hpp>\n#include "saltus/report/html.hpp"\n',
    "tests/unit/ode/stepper_test.cpp": '#include <gtest/gtest.h>\n#include "saltus/report/html.hpp"\n',
}


class Tree:
    """A small source tree in a temporary folder: the good one with some files added or replaced."""

    def __init__(self, changes):
        self.changes = changes

    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory()
        root = Path(self.folder.name)
        for name, text in {**GOOD, **self.changes}.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        return root

    def __exit__(self, *_):
        self.folder.cleanup()

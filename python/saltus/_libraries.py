"""Finds the libraries of the package casadi and loads them once, whoever asks first."""

from __future__ import annotations

import ctypes
import importlib.util
import pathlib
import sys

from ._build import CASADI

if sys.platform == "darwin":
    _LIBRARIES = ("libcasadi.*.dylib", "libipopt.3.dylib", "libhighs.1.dylib")
else:
    _LIBRARIES = ("libcasadi.so.*", "libipopt.so.3", "libhighs.so.1")


def _folder() -> pathlib.Path:
    spec = importlib.util.find_spec("casadi")
    if spec is None or spec.origin is None:
        raise ImportError(f"saltus needs the package casadi {CASADI}: pip install 'casadi=={CASADI}.*'")
    folder = pathlib.Path(spec.origin).parent
    found = _version(folder)
    if ".".join(found.split(".")[:2]) != CASADI:
        raise ImportError(
            f"saltus was built with casadi {CASADI} and found casadi {found}: pip install 'casadi=={CASADI}.*'"
        )
    return folder


def _version(folder: pathlib.Path) -> str:
    """Of the package casadi: by the name of its record, as the module that reads it takes longer than all else."""
    records = sorted(folder.parent.glob("casadi-*.dist-info"))
    if len(records) == 1:
        return records[0].name.removeprefix("casadi-").removesuffix(".dist-info")
    import importlib.metadata

    return importlib.metadata.version("casadi")


def load() -> None:
    """Loads what the extension links. The name of a library decides: casadi, imported later, finds the same one."""
    folder = _folder()
    for pattern in _LIBRARIES:
        files = sorted(folder.glob(pattern))
        if not files:
            raise ImportError(
                f"{folder} is not the package casadi: it has no {pattern}; is a file of yours called casadi?"
            )
        ctypes.CDLL(str(files[0]))

"""Finds the libraries of the package casadi and loads them once, whoever asks first."""

from __future__ import annotations

import ctypes
import importlib.metadata
import importlib.util
import pathlib

from ._build import CASADI

_LIBRARIES = ("libcasadi.so.*", "libipopt.so.3", "libhighs.so.1")


def _folder() -> pathlib.Path:
    spec = importlib.util.find_spec("casadi")
    if spec is None or spec.origin is None:
        raise ImportError(f"saltus needs the package casadi {CASADI}: pip install 'casadi=={CASADI}.*'")
    found = importlib.metadata.version("casadi")
    if ".".join(found.split(".")[:2]) != CASADI:
        raise ImportError(
            f"saltus was built with casadi {CASADI} and found casadi {found}: pip install 'casadi=={CASADI}.*'"
        )
    return pathlib.Path(spec.origin).parent


def load() -> None:
    """Loads what the extension links. The name of a library decides: casadi, imported later, finds the same one."""
    folder = _folder()
    for pattern in _LIBRARIES:
        for file in sorted(folder.glob(pattern))[:1]:
            ctypes.CDLL(str(file))

"""Models of any size, as the tool writes them."""
import subprocess

NAMES = {"chain": "spring-block", "rod": "thermostat-rod", "network": "gene-network", "ladder": "converter-ladder"}
PARTS = {"chain": "blocks", "rod": "cells", "network": "genes", "ladder": "stages"}


def text(tool, kind, n):
    """The text of the model file with n parts."""
    words = [tool, "models", NAMES[kind], "--set", f"{PARTS[kind]}={n}"]
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout

"""How the checks read sources."""


def lines_of(path):
    return path.read_text(encoding="utf-8", errors="replace").splitlines()

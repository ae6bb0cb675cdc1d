"""Builds the documentation: copies docs/ to build/site_source, adds the pages made by programs, runs Sphinx, checks.

usage: build.py [--quick]
"""

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
SOURCE, SITE = BUILD / "site_source", BUILD / "site"
sys.path.insert(0, str(Path(__file__).parent))

import accessible  # noqa: E402
import browser  # noqa: E402
import built  # noqa: E402
import measured  # noqa: E402
import tables  # noqa: E402


def environment():
    """What kernels and commands of the pages find: the tool, the package, pictures as drawings."""
    found = dict(os.environ)
    found["PATH"] = f"{BUILD / 'release/bin'}:{Path(sys.executable).parent}:{found['PATH']}"
    found["PYTHONPATH"] = f"{BUILD / 'release/python'}:{ROOT / 'scripts/site'}"
    found["IPYTHONDIR"] = str(BUILD / "site_ipython")
    found["MATPLOTLIBRC"] = str(ROOT / "scripts/site/matplotlibrc")
    found["MPLCONFIGDIR"] = str(BUILD / "site_ipython")
    found["SALTUS_SITE_ROOT"] = str(ROOT)
    profile = BUILD / "site_ipython/profile_default"
    profile.mkdir(parents=True, exist_ok=True)
    (profile / "ipython_kernel_config.py").write_text("c.InlineBackend.figure_formats = {'svg'}\n")
    return found


def copy_pages():
    shutil.rmtree(SOURCE, ignore_errors=True)
    shutil.copytree(ROOT / "docs", SOURCE)
    # Pages name programs as they are beside docs/ in the source tree and in installations.
    shutil.copytree(ROOT / "examples", SOURCE.parent / "examples", dirs_exist_ok=True)
    for name, page in (("CHANGELOG.md", "changes.md"), ("ARCHITECTURE.md", "architecture.md")):
        text = (ROOT / name).read_text().replace("](docs/adr)", "](decisions.md)").replace("](docs/", "](")
        # What the source tree has, and the site has not, is named without a link.
        (SOURCE / page).write_text(re.sub(r"\[([^\]]*)\]\((?:tests|examples|cmake|benchmarks|scripts|src|models|packaging|wasm|python)/[^)]*\)", r"\1", text))


def link_to_try():
    """The page in which models run, where scripts/wasm.sh has built it (docs/conf.py puts it into the site)."""
    if (BUILD / "wasm/try.html").exists():
        with open(SOURCE / "in-the-browser.md", "a", encoding="utf-8") as page:
            page.write('\n<p><a href="try.html"><strong>Open the page</strong></a></p>\n')


def doxygen():
    """The XML of the C++ reference; nothing where Doxygen is not installed."""
    if shutil.which("doxygen") is None:
        return False
    settings = (ROOT / "scripts/site/Doxyfile").read_text() + f"\nINPUT = {ROOT}/src/saltus\nOUTPUT_DIRECTORY = {BUILD}/site_cpp\n"
    (BUILD / "site_cpp").mkdir(exist_ok=True)
    subprocess.run(["doxygen", "-q", "-"], input=settings, text=True, check=True, stderr=subprocess.DEVNULL)
    for file in (BUILD / "site_cpp/xml").glob("*.xml"):
        text = file.read_text()
        # Sphinx reads neither designated initialisers nor lambdas, and Breathe shows private classes.
        mended = re.sub(r"<initializer>(= \[|[^<]*\{\.)(?:.|\n)*?</initializer>", "", text)
        mended = re.sub(r'\s*<innerclass [^>]*prot="private"[^>]*>[^<]*</innerclass>', "", mended)
        if mended != text:
            file.write_text(mended)
    return True


def main(quick):
    begin = time.monotonic()
    env = environment()
    copy_pages()
    link_to_try()
    os.environ.update(env)
    tables.write(SOURCE, BUILD / "release/bin/saltus", ROOT)
    measured.write(SOURCE, ROOT)
    if quick:
        env["SALTUS_SITE_QUICK"] = "1"
    else:
        pages = sorted((ROOT / "docs").rglob("*.md"))
        subprocess.run([sys.executable, ROOT / "scripts/site/blocks.py", BUILD / "release/bin/saltus", *pages], check=True,
                       env={**env, "MPLBACKEND": "Agg"}, stdout=subprocess.DEVNULL)
        subprocess.run([sys.executable, ROOT / "scripts/site/gallery.py", SOURCE / "gallery"], check=True, env=env)
        if doxygen():
            env["SALTUS_SITE_CPP"] = str(BUILD / "site_cpp/xml")
    tables.write_index(SOURCE, bool(env.get("SALTUS_SITE_CPP")), quick)
    print(f"pages made: {time.monotonic() - begin:.0f} s", flush=True)
    shutil.rmtree(SITE, ignore_errors=True)
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-j", "2", "-d", BUILD / "site_trees", "-b", "html", SOURCE, SITE],
        env=env, check=False,
    )
    if done.returncode != 0:
        sys.exit(done.returncode)
    accessible.mend(SITE)
    built.check(SITE)
    if complaints := browser.ask(SITE, ROOT / ".venv/axe/axe.min.js"):
        sys.exit("\n".join(complaints))
    print(f"build/site/index.html, {time.monotonic() - begin:.0f} s")


if __name__ == "__main__":
    main("--quick" in sys.argv[1:])

"""Settings of the documentation. `make site` copies this folder, adds the generated pages and builds them."""

import os
import re
import sys
from pathlib import Path

import myst_nb.core.render

root = Path(os.environ.get("SALTUS_SITE_ROOT", Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(root / "scripts/site"))
import streams  # noqa: E402

streams.mend(myst_nb.core.render)
project = "Saltus"
author = "The Saltus authors"
copyright = author  # noqa: A001: the name is Sphinx's
release = re.search(r'version = "([^"]+)"', (root / "src/saltus/base/version.hpp").read_text()).group(1)

extensions = ["myst_nb", "sphinx.ext.autodoc"]
if os.environ.get("SALTUS_SITE_CPP"):
    extensions.append("breathe")
    breathe_projects = {"saltus": os.environ["SALTUS_SITE_CPP"]}
    breathe_default_project = "saltus"
    breathe_show_include = False
    cpp_id_attributes = ["SALTUS_API"]

exclude_patterns = ["figures"]
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 4
nb_execution_mode = "force"
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
# Types of the implementation have no page of their own.
nitpicky = False
# Numbers and formats of our own are no language that a highlighter knows.
suppress_warnings = ["misc.highlighting_failure", "cpp.duplicate_declaration", "duplicate_declaration.cpp"]

html_theme = "furo"
html_title = f"Saltus {release}"
html_static_path = ["_static"]
html_css_files = ["saltus.css"]
html_copy_source = False
html_show_sourcelink = False
# What scripts/wasm.sh has built: the page in which models run.
html_extra_path = [str(page) for page in [root / "build/wasm/try.html"] if page.exists()]
html_theme_options = {"source_edit_link": "", "top_of_page_buttons": []}

"""Settings of the documentation site. ``./scripts/docs`` builds it; no step needs a network.

The folder ``extensions`` holds the parts of the site that are generated from the package.
"""

import logging
import os
import sys
from pathlib import Path

from fastpin.version import __version__

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs" / "extensions"))

# One thread for BLAS: the scripts of the gallery then take the same time everywhere.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# The solver tells of each run; the build stays quiet.
logging.getLogger("fastpin").setLevel(logging.WARNING)

project = "fastpin"
author = "fastpin developers"
copyright = author  # noqa: A001 (the name that Sphinx reads)
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx-mathjax-offline",
    "sphinx_gallery.gen_gallery",
    "generated_text",
    "no_network",
    "package_names",
]
exclude_patterns = ["beyond", "extensions", "gallery", "joss", "static"]
nitpicky = True
# Dashes only: quotes are those of a value.
smartquotes_action = "D"
# Words of types, such as "theta", may be the names of several attributes.
suppress_warnings = ["ref.python"]
today_fmt = "%Y-%m-%d"

# -- Markdown --------------------------------------------------------------------------------------------------

myst_enable_extensions = ["colon_fence", "dollarmath", "deflist"]
# GitHub draws a fence named "math" as a formula. So does the site.
myst_fence_as_directive = ["math"]
# Links name headings up to this level.
myst_heading_anchors = 3

# -- the reference ---------------------------------------------------------------------------------------------

autodoc_member_order = "groupwise"
# The docstrings name types in words.
autodoc_typehints = "none"
autodoc_default_options = {"members": True, "exclude-members": "index, count"}
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
python_maximum_signature_line_length = 100
toc_object_entries_show_parents = "hide"

# -- the gallery -----------------------------------------------------------------------------------------------

sphinx_gallery_conf = {
    "image_scrapers": ("figure_scraper.scrape",),
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "write_computation_times": False,
    "show_signature": False,
    "remove_config_comments": True,
    "reference_url": {"fastpin": None},
    "abort_on_example_error": True,
}

# -- pages -----------------------------------------------------------------------------------------------------

html_theme = "furo"
html_title = f"fastpin {__version__}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False
html_theme_options = {"navigation_with_keys": True}

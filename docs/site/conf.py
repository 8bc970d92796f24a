"""Settings of Sphinx for the documentation site; docs/make_site.py runs it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from make_site import SETTINGS, repository_address

import visuohaptic

project = "visuohaptic"
author = "The visuohaptic authors"
copyright = author  # noqa: A001 - Sphinx's name
version = release = visuohaptic.__version__
language = "en-GB"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinxcontrib.mermaid",
]
myst_heading_anchors = 4
myst_fence_as_directive = ["mermaid"]
mermaid_fullscreen = False
mermaid_height = "auto"
templates_path = [str(SETTINGS / "templates")]
autosummary_generate = True
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings tell the types
napoleon_google_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
default_role = "literal"
add_module_names = False
toc_object_entries = False

html_theme = "pydata_sphinx_theme"
html_title = "visuohaptic"
html_static_path = ["static"]
html_css_files = ["site.css"]
exclude_patterns = ["extra"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "header_links_before_dropdown": 6,
    "show_prev_next": False,
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
}
if repository_address() is not None:
    html_theme_options["icon_links"] = [
        {"name": "Repository", "url": repository_address(), "icon": "fa-solid fa-code-branch"}
    ]

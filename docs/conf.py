"""How Sphinx builds the documentation: Markdown pages, warnings are errors (`make docs`)."""

project = "Cellwright"
project_copyright = "The Cellwright developers"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
source_suffix = {".md": "markdown"}
root_doc = "index"
exclude_patterns: list[str] = []

# Headings down to this level can be linked to as #their-words, as on a code host.
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_url_schemes = ["http", "https"]

html_theme = "furo"
html_title = "Cellwright"
html_show_sourcelink = False
html_show_copyright = False

# Names between single backticks are code, as in Markdown.
default_role = "code"
# Docstrings are in Google style; types stand in the signatures.
autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints = "signature"
napoleon_numpy_docstring = False
napoleon_use_ivar = True

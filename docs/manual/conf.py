"""Settings of the manual; `make manual` builds it with Sphinx."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import dualarm_pin  # noqa: E402

project = "dualarm_pin"
version = release = dualarm_pin.__version__
copyright = "MIT licence"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "generate"]
exclude_patterns = ["results"]
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence"]
highlight_language = "none"

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True

html_theme = "furo"
html_title = f"dualarm_pin {version}"
html_static_path = ["assets"]
html_css_files = ["manual.css"]
html_copy_source = False
html_show_sphinx = False

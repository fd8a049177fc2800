"""How the documentation is built: ``sphinx-build -W docs docs/_build``.

Nothing is fetched. Tutorials and how-to pages are notebooks that run while it is built.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent)]
# Kernels are processes of their own: they find the checkout, show figures, keep to one thread.
os.environ["PYTHONPATH"] = os.pathsep.join(
    filter(None, [str(HERE.parent), os.environ.get("PYTHONPATH", "")])
)
os.environ["MPLBACKEND"] = "module://matplotlib_inline.backend_inline"
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")
os.environ.pop("RACS_BIF_PATH", None)  # the pages tell of what everybody has

from racs_bif import __version__  # noqa: E402  # the path is set above

project = "racs_bif"
author = "racs_bif developers"
version = release = __version__
language = "en"

extensions = ["sphinx.ext.autodoc", "numpydoc", "myst_nb", "filling", "mathml"]
source_suffix = {".md": "myst-nb"}
root_doc = "index"
exclude_patterns = ["_build", "_ext", "jupyter_execute"]
default_role = "py:obj"
smartquotes = False
add_module_names = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings tell types, with shapes and units
numpydoc_show_class_members = False
numpydoc_attributes_as_param_list = False

myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_execution_in_temp = True
nb_execution_show_tb = True
nb_merge_streams = True
nb_number_source_lines = False

html_math_renderer = "mathml"  # browsers draw it themselves: no script, no network
html_theme = "furo"
html_title = f"racs_bif {__version__}"
html_static_path: list[str] = []
html_show_copyright = False

"""How `backhoe lessons` turns the notebooks into pages that need no network."""

import json
from pathlib import Path

from docutils import nodes
from myst_nb.core.render import NbElementRenderer

from backhoe.course.folding import fold

project = "Backhoe"
author = "the Backhoe maintainers"
project_copyright = "the Backhoe maintainers, CC BY 4.0"
language = "en"

extensions = ["myst_nb"]
exclude_patterns = ["_static", "**.ipynb_checkpoints"]
myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath"]
myst_heading_anchors = 3

WIDGET = "application/vnd.jupyter.widget-view+json"
nb_execution_mode = "off"
nb_merge_streams = True
nb_ipywidgets_js = {}
nb_mime_priority_overrides = [("html", WIDGET, None)]

pygments_dark_style = "one-dark"
html_theme = "furo"
html_title = "Backhoe"
html_static_path = ["_static"]
html_css_files = ["lessons.css"]
html_copy_source = False
html_show_search_summary = False  # a page opened from disk may not fetch its neighbours
html_show_sourcelink = False
mathjax_path = "mathjax/tex-svg-full.js"

_render_image = NbElementRenderer.render_image


def _render_image_with_text(renderer, data):
    """The image as myst-nb makes it, with the text that `plots.show` stores beside it."""
    images = _render_image(renderer, data)
    outputs = renderer.renderer.nb_client.code_cell_outputs(data.cell_index)[1]
    # By what it shows: myst-nb counts outputs after it has joined printed text, we before.
    bundles = [output["data"] for output in outputs if "data" in output]
    texts = (bundle.get("text/plain", "") for bundle in bundles if data.content in bundle.values())
    text = next(texts, "")
    for image in images:
        image.setdefault("alt", text)
    return images


ALONE = "% the machine alone: the first replay of 14b_report"


def _with_replay(app, name, source):
    """The front page with the replay of the whole mission, as it is stored in its sitting."""
    sitting = Path(app.srcdir, "14b_report.ipynb")
    if name != "index" or ALONE not in source[0] or not sitting.exists():
        return
    cells = json.loads(sitting.read_text(encoding="utf-8"))["cells"]
    pages = (
        "".join(output["data"]["text/html"])
        for cell in cells
        for output in cell.get("outputs", [])
        if "text/html" in output.get("data", {})
    )
    fence = "`" * 12
    replay = f"{fence}{{raw}} html\n{next(pages, '')}\n{fence}"
    source[0] = source[0].replace(ALONE, replay)


def _keep_numbers(app, doctree):
    """Sphinx wraps formulas of several lines in `split`, where MathJax refuses their number."""
    for formula in doctree.findall(nodes.math_block):
        if r"\tag" in formula.astext():
            formula.children = [nodes.Text(rf"\[{formula.astext()}\]")]
            formula["nowrap"] = formula["no-wrap"] = True


def setup(app):
    NbElementRenderer.render_image = _render_image_with_text
    app.connect("source-read", _with_replay)
    app.connect("doctree-read", _keep_numbers)
    app.connect("doctree-read", fold)

"""On the pages, what comes after a prediction is behind a button: first think, then look.

Hidden is what the code after a prediction shows, and the text below it, up to the next code, the
next prediction or the next heading; the code itself stays. Where an exercise says "Do this before
you read on", all after its cell is hidden, up to the next heading. The button is a checkbox with a
style sheet: it works by keyboard and without a network or a script, and printed pages show all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from docutils import nodes

PREDICT = "Predict before you run."
THINK = "Do this before you read on"
"""How a text begins, in bold, whose answer shall not be seen at once."""

BUTTON = (
    '<input type="checkbox" class="answer-box" id="answer-{0}">'
    '<label class="answer-button" for="answer-{0}">{1}</label>'
)


def fold(app: object, doctree: nodes.document) -> None:
    """Hide the answers of a page; a handler of Sphinx's event `doctree-read`."""
    from docutils import nodes

    asked = [one for one in doctree.findall(nodes.paragraph) if _asks(one)]
    for number, question in enumerate(asked, 1):
        _hide(question, number, asked)


def _asks(paragraph: nodes.paragraph) -> bool:
    from docutils import nodes

    text = " ".join(one.astext() for one in paragraph.findall(nodes.strong))
    return PREDICT in text or THINK.lower() in text.lower()


def _hide(question: nodes.paragraph, number: int, asked: list) -> None:
    from docutils import nodes

    place = question
    while not isinstance(place.parent, nodes.section | nodes.document):
        place = place.parent
    after = place.parent.children[place.parent.index(place) + 1 :]
    runs, hidden, told = PREDICT in question.astext(), [], False
    for one in after:
        ends = isinstance(one, nodes.section) or any(two in asked for two in one.findall())
        if ends or (runs and told and _is_cell(one)):
            break
        if hidden or (not runs and not _is_cell(one)):
            told = told or not _is_cell(one)
            hidden.append(one)
        elif runs and _is_cell(one):
            hidden += [part for part in one.children if "cell_output" in part["classes"]]
    if not hidden:
        return
    answer = nodes.container(classes=["answer"])
    first = hidden[0]
    if first in after:
        first.parent.insert(first.parent.index(first), answer)
    else:  # what a cell shows, as a cell of its own
        cell = first.parent
        cell.parent.insert(cell.parent.index(cell) + 1, answer)
    shown = nodes.container(classes=["answer-text"])
    for one in hidden:
        one.parent.remove(one)
        if "cell_output" in one.get("classes", ()):
            one = nodes.container("", one, classes=["cell"])
        shown += one
    label = "Show what happens" if runs else "Show the answer"
    answer += nodes.raw("", BUTTON.format(number, label), format="html")
    answer += shown


def _is_cell(node: nodes.Node) -> bool:
    return "cell" in getattr(node, "attributes", {}).get("classes", ())

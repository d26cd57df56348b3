"""On the pages an answer is behind a button, and only the answer."""

import pytest
from docutils import nodes, utils

from backhoe.course.folding import fold


def text(words, strong=""):
    paragraph = nodes.paragraph("", "")
    if strong:
        paragraph += nodes.strong("", strong)
    paragraph += nodes.Text(words)
    return paragraph


def cell(code, output=None):
    parts = [nodes.container("", nodes.literal_block("", code), classes=["cell_input"])]
    if output:
        parts.append(nodes.container("", nodes.literal_block("", output), classes=["cell_output"]))
    return nodes.container("", *parts, classes=["cell"])


def page(*children):
    document = utils.new_document("page")
    document += nodes.section("", nodes.title("", "Title"), *children)
    fold(None, document)
    return document


def hidden(document):
    shown = [one for one in document.findall(nodes.container) if "answer-text" in one["classes"]]
    return [" ".join(one.astext().split()) for one in shown]


PREDICTION = ("How far?", "Predict before you run. ")


def test_what_the_code_shows_and_the_text_below_are_hidden_but_not_the_code():
    document = page(
        text(*PREDICTION), text("My prediction"), cell("run()", "5 m"), text("Five."), cell("go()")
    )
    assert hidden(document) == ["5 m Five."]
    assert document.astext().index("run()") < document.astext().index("5 m")
    assert document.astext().endswith("go()")


def test_all_cells_of_one_run_belong_to_the_answer():
    cells = cell("first()"), cell("second()", "5 m"), cell("third()", "6 m")
    document = page(text(*PREDICTION), *cells, text("Five."))
    assert hidden(document) == ["5 m third() 6 m Five."]


def test_a_heading_and_the_next_prediction_end_it():
    deeper = nodes.section("", nodes.title("", "More"), text("open"))
    document = page(text(*PREDICTION), cell("a", "1"), text(*PREDICTION), cell("b", "2"), deeper)
    assert hidden(document) == ["1", "2"]


def test_every_answer_has_a_button_of_its_own():
    document = page(text(*PREDICTION), cell("a", "1"), text(*PREDICTION), cell("b", "2"))
    buttons = [one.astext() for one in document.findall(nodes.raw)]
    assert ["answer-1" in buttons[0], "answer-2" in buttons[1]] == [True, True]


def test_an_exercise_to_do_first_keeps_its_cell_and_hides_the_rest():
    question = text("the next cell tells.", "Do this before you read on. ")
    document = page(question, cell("check()", "not done yet"), text("Here."), cell("found()", "7"))
    assert hidden(document) == ["Here. found() 7"]


@pytest.mark.parametrize("after", [[], [cell("a")], [text("nothing is run")]])
def test_where_nothing_is_shown_nothing_is_hidden(after):
    assert hidden(page(text(*PREDICTION), *after)) == []

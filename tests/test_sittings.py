"""A sitting, a notebook such as `08a_camera`, fits into an hour of a tired student's evening."""

import re

import pytest

from backhoe.course.catalogue import LESSONS, lesson
from sittings import EXERCISE, SITTINGS, minutes, prose, read, verdicts, words


@pytest.fixture(params=SITTINGS, ids=lambda path: path.stem)
def cells(request):
    return read(request.param)


def test_it_takes_at_most_an_hour_and_says_how_long(cells):
    time = minutes(cells)
    said = re.search(r"\*\*Time\.\*\* About (\d+) minutes", prose(cells))
    assert time <= 60 and said
    assert abs(time - int(said[1])) <= 4


def test_it_has_at_most_three_thousand_words(cells):
    assert words(cells) <= 3000


def test_it_teaches_what_is_right_and_leaves_the_trial_to_the_appendix(cells):
    assert verdicts(cells) <= 0.08


def test_it_has_three_to_five_exercises_of_five_to_twenty_minutes(cells):
    times = [int(time) for _, time in EXERCISE.findall(prose(cells))]
    assert 3 <= len(times) <= 5
    assert all(5 <= time <= 20 for time in times)


def test_it_has_predictions(cells):
    assert prose(cells).count("**Predict before you run.**") >= 2


@pytest.mark.parametrize("chapter", sorted({str(int(path.stem[:2])) for path in SITTINGS}))
def test_the_sittings_of_a_chapter_ask_each_of_its_exercises_once(chapter):
    assert LESSONS[chapter]
    paths = [path for path in SITTINGS if int(path.stem[:2]) == int(chapter)]
    asked = [number for path in paths for number, _ in EXERCISE.findall(prose(read(path)))]
    assert asked == list(lesson(chapter))


def shown(cell):
    """What the figures of a cell are said to show, one text a figure."""
    outputs = cell.get("outputs", ())
    return [
        output["data"]["text/plain"] for output in outputs if "image/png" in output.get("data", {})
    ]


def test_each_figure_has_its_number_and_a_caption(cells):
    """All but the small map of the machine on top, which has no number."""
    captions = re.findall(r"^\*Figures? (\d+(?: and \d+)?)\. ", prose(cells), re.MULTILINE)
    numbers = [number for caption in captions for number in caption.split(" and ")]
    figures = [text for cell in cells for text in shown(cell)]
    assert [int(number) for number in numbers] == list(range(1, len(numbers) + 1))
    assert len(numbers) == len(figures) - figures[0].startswith("The way of the data")


def test_a_figure_is_told_by_the_program_with_quantities_and_units(cells):
    for text in (text for cell in cells for text in shown(cell)):
        drawn = text.partition("Drawn: ")[2]
        assert drawn, text
        assert "no name" not in drawn and not re.search(r"(; |, |: |\) )\[", drawn), drawn

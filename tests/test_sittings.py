"""A sitting, a notebook such as `08a_camera`, fits into an hour of a tired student's evening."""

import re
from pathlib import Path

import nbformat
import pytest

from backhoe.course.catalogue import LESSONS, lesson

ROOT = Path(__file__).resolve().parents[1]
SITTINGS = sorted((ROOT / "notebooks").glob("[0-9][0-9][a-z]_*.ipynb"))
READ, TYPED = 150, 12  # words and lines of code a minute
PREDICTION, FIGURE = 2.0, 0.5  # minutes
EXERCISE = re.compile(r"^### Exercise (\d+\.\d+): .* \((\d+) min\)$", re.MULTILINE)


@pytest.fixture(params=SITTINGS, ids=lambda path: path.stem)
def cells(request):
    return nbformat.read(request.param, as_version=4).cells


def prose(cells):
    return "\n\n".join(cell.source for cell in cells if cell.cell_type == "markdown")


def words(cells):
    """Words that are read: no code, formulas, pictures' texts or answers behind a button."""
    not_words = r"```.*?```|\$\$.*?\$\$|</?[a-z][^<>]*>|\]\([^)]*\)"
    text = re.sub(not_words, " ", prose(cells), flags=re.DOTALL)
    return len(re.findall(r"\w[\w'-]*", re.sub(r"\$[^$]*\$", " x ", text)))


def minutes(cells):
    """Time of a sitting by the course's formula [min]."""
    code = [cell for cell in cells if cell.cell_type == "code"]
    lines = sum(bool(line.strip()) for cell in code for line in cell.source.splitlines())
    shown = [kind for cell in code for output in cell.outputs for kind in output.get("data", {})]
    figures = sum(kind in ("image/png", "text/html") for kind in shown)
    exercises = sum(int(time) for _, time in EXERCISE.findall(prose(cells)))
    predictions = prose(cells).count("**Predict before you run.**")
    reading = words(cells) / READ + lines / TYPED
    return reading + PREDICTION * predictions + FIGURE * figures + exercises


def test_it_takes_at_most_an_hour_and_says_how_long(cells):
    time = minutes(cells)
    said = re.search(r"\*\*Time\.\*\* About (\d+) minutes", prose(cells))
    assert time <= 60 and said
    assert abs(time - int(said[1])) <= 4


def test_it_has_at_most_three_thousand_words(cells):
    assert words(cells) <= 3000


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
    asked = [
        number
        for path in paths
        for number, _ in EXERCISE.findall(prose(nbformat.read(path, as_version=4).cells))
    ]
    assert asked == list(lesson(chapter))

"""The strong sentences of our own lessons: each has a test, or is no claim and says why.

`data/claims.csv` quotes them. A sentence with one of the words below that is quoted nowhere fails.
"""

import csv
import re
from pathlib import Path

import nbformat
import pytest

ROOT = Path(__file__).resolve().parents[1]
STRONG = re.compile(
    r"\b(always|never|every|stays?|whatever|worse|worst|impossible|guarantees?d?|because of"
    r"|no matter)\b",
    re.IGNORECASE,
)
with (ROOT / "data" / "claims.csv").open(encoding="utf-8", newline="") as file:
    TABLE = csv.DictReader(file)
    CLAIMS = list(TABLE)
LESSONS = sorted({claim["lesson"] for claim in CLAIMS})


def prose(lesson):
    """Everything that a lesson says in words, on one line a cell, without its code."""
    (path,) = (ROOT / "notebooks").glob(f"{lesson}_*.ipynb")
    cells = nbformat.read(path, as_version=4).cells
    texts = [cell.source for cell in cells if cell.cell_type == "markdown"]
    return [" ".join(re.sub(r"```.*?```", "", text, flags=re.DOTALL).split()) for text in texts]


def sentences(lesson):
    for text in prose(lesson):
        yield from re.split(r"(?<=[.!?])\s+", text)


def test_the_columns_are_the_agreed_ones():
    assert TABLE.fieldnames == ["lesson", "claim", "test", "no claim because"]


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: f"{claim['lesson']} {claim['claim']}")
def test_a_claim_is_made_in_its_lesson_and_has_a_test_or_is_none(claim):
    assert any(claim["claim"] in text for text in prose(claim["lesson"]))
    assert bool(claim["test"]) != bool(claim["no claim because"])
    if claim["test"]:
        path, _, test = claim["test"].partition("::")
        assert re.search(rf"def {re.escape(test)}\(", (ROOT / path).read_text(encoding="utf-8"))


@pytest.mark.parametrize("lesson", LESSONS)
def test_a_strong_sentence_is_quoted(lesson):
    quoted = [claim["claim"] for claim in CLAIMS if claim["lesson"] == lesson]
    strong = [text for text in sentences(lesson) if STRONG.search(text)]
    assert not [text for text in strong if not any(claim in text for claim in quoted)]


@pytest.mark.parametrize("lesson", LESSONS)
def test_most_of_them_are_claims(lesson):
    """Instructions and definitions are few: the register is about what can be false."""
    own = [claim for claim in CLAIMS if claim["lesson"] == lesson]
    assert sum(bool(claim["test"]) for claim in own) >= len(own) / 2

"""How long a sitting takes, by the course's formula; run it for the table of all notebooks.

    python tests/sittings.py

Minutes = words / 150 + lines of code / 12 + 2 a prediction + 0.5 a figure + exercises as declared.
Verdicts are the sentences that judge what a source prints.
"""

import re
import sys
from pathlib import Path

import nbformat

ROOT = Path(__file__).resolve().parents[1]
SITTINGS = sorted((ROOT / "notebooks").glob("[0-9][0-9]*_*.ipynb"))
READ, TYPED = 150, 12  # words and lines of code a minute
PREDICTION, FIGURE = 2.0, 0.5  # minutes
EXERCISE = re.compile(r"^### Exercise (\d+\.\d+): .* \((\d+) min\)$", re.MULTILINE)


VERDICT = re.compile(
    r"\b(printed|prints|misprint|thesis|sources?'?s?|Mastalli|D'Angelo|S[\u00e1a]sig|guide)\b|\(\d\.\d+[a-z]?\)"
)


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


def verdicts(cells):
    """Share of the words that stand in a sentence on what a source prints."""
    shares = 0
    for cell in cells:
        if cell.cell_type == "markdown":
            for sentence in re.split(r"(?<=[.!?:])\s+", cell.source):
                if VERDICT.search(sentence):
                    shares += words([nbformat.v4.new_markdown_cell(sentence)])
    return shares / max(words(cells), 1)


def read(path):
    """Its cells."""
    return nbformat.read(path, as_version=4).cells


def main():
    print(f"{'sitting':24s} {'words':>6s} {'minutes':>8s} {'verdicts':>9s}")
    for path in SITTINGS:
        cells = read(path)
        print(f"{path.stem:24s} {words(cells):6d} {minutes(cells):8.1f} {verdicts(cells):9.0%}")


if __name__ == "__main__":
    sys.exit(main())

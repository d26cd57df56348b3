"""What the figures of lesson 08a show is what they were given."""

import numpy as np
import pytest

from backhoe.lessons.stereo.figures import camera as figures
from drawn import Panel, line, picture, proofs, track

RNG = np.random.default_rng(8)
LEFT, RIGHT = RNG.integers(0, 256, (2, 24, 32), dtype=np.uint8)
CORNERS, SEEN = np.array([[3.0, 4.0], [20.0, 9.5]]), np.array([[5.0, 14.0]])
EDGE, OTHER = (
    np.array([[1.0, 2.0], [12.0, 7.0], [30.0, 9.0]]),
    np.array([[2.0, 20.0], [29.0, 11.0]]),
)
EDGES = (-0.5, 31.5, 23.5, -0.5)
COLUMN, ROW = "column [pixels]", "row [pixels]"


def pictured():
    fig = figures.pictures(
        {"left": LEFT, "right": RIGHT},
        [{"corner": CORNERS}, {"corner": SEEN, "other": CORNERS + 1}],
        [{}, {"edge": [EDGE, OTHER]}],
    )
    left = [picture(LEFT, EDGES, (0, 255)), track(CORNERS, "corner")]
    right = [picture(RIGHT, EDGES, (0, 255)), track(SEEN, "corner"), track(CORNERS + 1, "other")]
    right += [track(EDGE, "edge"), track(OTHER, "_edge")]
    return fig, [Panel(COLUMN, ROW, left, "left"), Panel(COLUMN, "", right, "right")]


def alone():
    return figures.pictures({"left": LEFT}, lines=[{"edge": [EDGE, OTHER]}]), [
        Panel(
            COLUMN,
            ROW,
            [picture(LEFT, EDGES, (0, 255)), track(EDGE, "edge"), track(OTHER, "_edge")],
            "left",
        )
    ]


def errors():
    real, made = 0.3 * RNG.standard_normal((2, 20, 2))
    turn = np.linspace(0, 2 * np.pi, 91)
    panels = []
    for title, e in (("photographs", real), ("rendered", made)):
        rms = np.sqrt((e**2).sum() / len(e))
        ring = np.c_[rms * np.cos(turn), rms * np.sin(turn)]
        items = [track(e, "corners"), track(ring, "root mean square")]
        panels.append(Panel("across [pixels]", "down [pixels]" * (not panels), items, title))
    return figures.residuals({"photographs": real, "rendered": made}), panels


def paid():
    counts, said = np.array([3.0, 6.0, 12.0]), np.array([2.0, 1.5, 1.1])
    e = RNG.uniform(0.5, 3.0, (3, 4)) * [1, -1, 1, -1]
    items = [
        line([3] * 4 + [6] * 4 + [12] * 4, np.abs(e).reshape(-1), "one calibration"),
        line(counts, [np.sqrt(np.mean(np.square(row))) for row in e], "root mean square of these"),
        line(counts, said, "deviation that they give themselves"),
    ]
    panel = Panel("boards [1]", "error of $f_x$ [pixels]", items, scales=("linear", "log"))
    return figures.boards(counts, e, said), [panel]


CASES = {"pictures": pictured, "pictures alone": alone, "residuals": errors, "boards": paid}
TestDrawn = proofs(figures, CASES)


@pytest.mark.parametrize(
    "draw",
    [
        lambda: figures.pictures({}),
        lambda: figures.pictures({"left": LEFT / 2}),
        lambda: figures.pictures({"left": LEFT}, [{"corner": [1.0, 2.0]}]),
        lambda: figures.residuals({}),
        lambda: figures.boards([3, 4], [[1.0]], [1.0, 2.0]),
    ],
)
def test_what_cannot_be_drawn_is_named(draw):
    with pytest.raises(ValueError):
        draw()

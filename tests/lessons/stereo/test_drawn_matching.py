"""What the figures of lesson 08b show is what they were given."""

import numpy as np
import pytest

from backhoe.lessons.stereo.figures import matching as figures
from drawn import Panel, line, picture, proofs

COLUMN, ROW = "column [pixels]", "row [pixels]"
GREY = np.arange(48, dtype=np.uint8).reshape(6, 8) * 5
DISPARITY = np.where(np.arange(48).reshape(6, 8) % 5, np.linspace(3, 60, 48).reshape(6, 8), np.nan)
EDGES = (-0.5, 7.5, 5.5, -0.5)


def maps():
    fig = figures.maps({"eye": GREY, "found": DISPARITY}, (0, 64))
    left = Panel(COLUMN, ROW, [picture(GREY, EDGES, (0, 255))], "eye")
    return fig, [left, Panel(COLUMN, "", [picture(DISPARITY, EDGES, (0, 64))], "found")]


def maps_halved():
    given = {name: DISPARITY + k for k, name in enumerate("abc")}
    fig = figures.maps(given, (0, 70), every=2)
    shown = [picture(d[::2, ::2], EDGES, (0, 70)) for d in given.values()]
    return fig, [
        Panel("", ROW, shown[:1], "a"),
        Panel("", "", shown[1:2], "b"),
        Panel(COLUMN, ROW, shown[2:], "c"),
    ]


def verdicts():
    truth = np.full((6, 8), 20.0)
    truth[0, 0] = np.nan
    found = np.full((6, 8), 20.9)
    found[0], found[2, 3], found[3, 3] = 21.5, np.nan, 18.9
    kind = np.ones((6, 8))
    kind[0], kind[2, 3], kind[3, 3] = 2, 0, 2
    fig = figures.verdicts({"one": found, "true": truth}, truth)
    other = np.ones((6, 8))
    other[0, 0] = 0
    panels = [
        Panel(COLUMN, y, [picture(values, EDGES, (-0.5, 2.5))], title)
        for y, title, values in ((ROW, "one", kind), ("", "true", other))
    ]
    labels = [text.get_text() for text in fig.axes[-1].get_yticklabels()]
    assert labels == ["none", "right", "wrong"]
    return fig, panels


def along_the_rays():
    truth, seen = np.array([[5.0, 1.0], [10.0, -4.0]]), np.array([[5.1, 1.02], [9.8, -3.92]])
    fig = figures.along_the_rays(truth, seen, [0.05, 0.2], stretch=3)
    shown = truth + 3 * (seen - truth)
    items = [
        line(*np.transpose([[4.7, 0.94], [5.3, 1.06]])),
        line(*np.transpose([[8.8, -3.52], [11.2, -4.48]])),
        line(*truth.T, "truth"),
        line(*shown.T, "seen"),
        line(0, 0, "left eye"),
    ]
    return fig, [Panel("ahead [m]", "to the left [m]", items)]


TestFigures = proofs(
    figures,
    {
        "maps": maps,
        "maps halved": maps_halved,
        "verdicts": verdicts,
        "along_the_rays": along_the_rays,
    },
)


@pytest.mark.parametrize(
    "draw, says",
    [
        (lambda: figures.maps({}), "a panel"),
        (lambda: figures.maps({"a": GREY}, every=0), "every"),
        (lambda: figures.maps({"a": GREY[0]}), "rows, columns"),
        (lambda: figures.verdicts({}, DISPARITY), "a panel"),
        (lambda: figures.verdicts({"a": DISPARITY[1:]}, DISPARITY), "a must"),
        (lambda: figures.along_the_rays(np.ones((3, 2)), np.ones((2, 2)), [1, 1, 1]), "seen"),
        (lambda: figures.along_the_rays(np.ones((3, 2)), np.ones((3, 2)), [1, 1]), "deviations"),
    ],
)
def test_bad_input_is_named(draw, says):
    with pytest.raises(ValueError, match=says):
        draw()

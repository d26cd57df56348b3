"""What the figures of lesson 11a show is what they were given."""

import numpy as np
import pytest

from backhoe.lessons.planning.figures import search as figures
from backhoe.planning.search import Log
from backhoe.view.plots.drawing import draw_arm, side_axes
from drawn import Panel, cells, ellipse, line, part, proofs, shape, track


def yard():
    heaps, reach = np.array([[2.0, 3.0, 0.5], [6.0, 1.0, 0.8]]), 1.2
    log = Log(np.array([[0.5, 0.5], [1.5, 0.7], [2.5, 0.2]]), np.array([[0, 1], [1, 2]]))
    ways = {
        "wide": {"optimum": [[0.5, 0.5], [3, 0.4], [7, 4]], "found": [[0.5, 0.5], [7, 4]]},
        "bare": {"other": [[0.5, 0.5], [5, 4], [7, 3.5]]},
    }
    fig = figures.yard(heaps, reach, ways, [[0, 0], [8, 5]], {"wide": log})
    nan = [np.nan, np.nan]
    panels = []
    for title, lines in ways.items():
        items = [ellipse((x, y), 2 * r, 2 * r) for x, y, r in heaps]
        items += [ellipse((x, y), 2 * (r + 1.2), 2 * (r + 1.2)) for x, y, r in heaps]
        items += [track(way, label) for label, way in lines.items()]
        if title == "wide":
            points = [[0.5, 0.5], [1.5, 0.7], nan, [1.5, 0.7], [2.5, 0.2], nan]
            items.append(track(points, "_tree"))
        first = next(iter(lines.values()))
        items += [line(*first[0], "start"), line(*first[-1], "goal")]
        panels.append(Panel("$x$ [m]", "$y$ [m]", items, title))
    return fig, panels


def two_joints():
    boom, stick = np.radians([0.0, 10.0, 20.0]), np.radians([-30.0, -25.0])
    free = np.array([[True, False, True], [False, False, True]])
    ways = {"found": np.radians([[1, -30], [19, -26]]), "short": np.radians([[1, -30], [12, -28]])}
    shown = np.array([[-np.pi / 2, 0.2, 0.3, 0.1], [-np.pi / 2, 0.5, 0.0, 0.1]])
    box = [[5.0, 0.0], [5.5, 2.0]]
    fig = figures.two_joints(boom, stick, free, ways, [box], shown)
    chart = [
        cells([-5.0, 5.0, 15.0, 25.0], [-32.5, -27.5, -22.5], free.astype(float)),
        *(track(np.degrees(way), label) for label, way in ways.items()),
        line(1.0, -30.0, "start"),
        line(12.0, -28.0, "goal"),
    ]

    def arms(ax):
        for q in shown:
            draw_arm(ax, q)
        side_axes(ax, (-2.6, 9.4, -1.0, 7.6))

    side = [shape([(5.0, 0.0), (5.5, 0.0), (5.5, 2.0), (5.0, 2.0)]), *part(arms)]
    reach = "distance from the swing axis [m]"
    return fig, [
        Panel("boom [deg]", "stick [deg]", chart, "brown: hits something"),
        Panel(reach, "height $z$ [m]", side, "from the side", clipped=True),
    ]


TestDrawn = proofs(figures, {"yard": yard, "two_joints": two_joints})


def test_a_yard_without_panels_is_refused():
    with pytest.raises(ValueError, match="at least one panel"):
        figures.yard([[0, 0, 1]], 1.0, {}, [[0, 0], [1, 1]])


def test_what_is_free_is_white():
    """Brown is what hits: the colours of the two values."""
    fig, _ = two_joints()
    mesh = fig.axes[0].collections[0]
    free, hit = mesh.cmap(mesh.norm(1.0)), mesh.cmap(mesh.norm(0.0))
    assert free == (1.0, 1.0, 1.0, 1.0) and hit[0] > hit[2] and sum(hit[:3]) < 2

"""What the figures of lesson 09c show is what they were given."""

import numpy as np

from backhoe.lessons.voxel_map.figures import terrain as figures
from drawn import Item, Panel, line, proofs, track


def cells(x, y, values):
    """A mesh around the middles, which are evenly spaced."""
    edges = [np.append(m - np.diff(m)[0] / 2, m[-1] + np.diff(m)[0] / 2) for m in (x, y)]
    corners = np.meshgrid(*edges)
    return Item("cells", np.concatenate([c.ravel() for c in (*corners, values)]))


def layers():
    points = np.random.default_rng(0).normal(size=(20, 3))
    soil = np.arange(20) % 3 > 0
    panels = []
    for row, label in ((0, "$x$ [m]"), (2, "$z$ [m]")):
        items = [
            track(points[mask][:, [1, row]], name)
            for mask, name in ((soil, "ground"), (~soil, "things"))
        ]
        panels.append(Panel("$y$ [m], left is left", label, items))
    fig = figures.layers(points, soil)
    assert fig.axes[0].get_xlim()[0] > fig.axes[0].get_xlim()[1]
    return fig, panels


def maps():
    x, y = np.array([1.0, 1.5, 2.0]), np.array([-1.0, -0.5])
    one, other = np.arange(6.0).reshape(2, 3), np.array([[3.0, np.nan, 1.0], [0.0, 2.0, 5.0]])
    outline = np.array([[1.0, -0.9], [1.8, -0.6]])
    fig = figures.maps(x, y, {"a": one, "b": other}, "height [m]", (0.0, 6.0), outline)
    assert fig.axes[-1].get_ylabel() == "height [m]"
    assert all(ax.collections[0].get_clim() == (0.0, 6.0) for ax in fig.axes[:2])
    return fig, [
        Panel("$x$ [m]", "" if k else "$y$ [m]", [cells(x, y, v), track(outline)], title)
        for k, (title, v) in enumerate((("a", one), ("b", other)))
    ]


def coverage():
    errors, deviations = np.array([0.1, -3.0, 0.5]), np.array([0.2, 1.0, 0.5])
    bar = [(-0.292, 0.492), (-4.96, -1.04), (-0.48, 1.48)]

    def bars(runs):
        runs = list(runs)
        x = np.repeat(np.array(runs, float), 3)
        return line(x, np.concatenate([[*bar[k], np.nan] for k in runs]))

    items = [line([0, 1], [0, 0]), bars([0, 2]), bars([1])]
    items += [line(np.array([0.0, 2.0]), errors[[0, 2]]), line(1.0, -3.0)]
    fig = figures.coverage({"naive": (errors, deviations)}, "error [l]")
    assert fig.axes[0].lines[1].get_color() != fig.axes[0].lines[3].get_color()
    return fig, [Panel("run [1]", "error [l]", items, "naive: 2 of 3 hold the truth")]


TestDrawn = proofs(figures, {"layers": layers, "maps": maps, "coverage": coverage})

"""What the figures of lesson 09b show is what they were given."""

import numpy as np
import pytest

from backhoe.lessons.voxel_map.figures import occupancy as figures
from drawn import Item, Panel, cells, line, proofs, shape, track

TURN, RISE = 0.6, 0.5


def seen(points):
    """Right and up of an eye that goes round by TURN and up by RISE: two rotations, one by one."""
    x, y, z = np.asarray(points, dtype=float).T
    ahead, right = x * np.cos(TURN) + y * np.sin(TURN), -x * np.sin(TURN) + y * np.cos(TURN)
    return np.stack([right, z * np.cos(RISE) - ahead * np.sin(RISE)], axis=-1)


def slices():
    x, y = np.array([0.0, 0.2, 0.4, 0.6]), np.array([0.0, 0.2, 0.4])
    upper = np.array([[1.0, np.nan, -0.8], [3.48, -2.0, 0.5]])
    lower = -upper / 2
    ground, laser = [(0.0, 0.05), (0.6, 0.15)], (0.3, 0.3)
    panels = [
        Panel(
            label,
            "up [m]",
            [cells(x, y, odds), track(ground, "true surface"), line(*laser, "laser")],
            title,
        )
        for title, odds, label in (("a", upper, ""), ("b", lower, "along [m]"))
    ]
    given = {"a": (x, y, upper), "b": (x, y, lower)}
    return figures.slices(
        given, "along [m]", "up [m]", truth=ground, sensor=laser, stretch=2.0
    ), panels


def cubes():
    """Two cubes side by side and one alone: the faces between the two are not drawn."""
    middles = np.array([(0.25, 0.25, 0.25), (0.25, 0.75, 0.25), (2.25, -1.25, 0.75)])
    items = []
    for number, middle in enumerate(middles):
        for axis in range(3):
            if number == 0 and axis == 1:
                continue
            u, v = np.delete(np.eye(3), axis, axis=0) * 0.25
            face = middle + np.eye(3)[axis] * 0.25 + np.array([-u - v, u - v, u + v, v - u])
            items.append(shape(seen(face)))
    items.append(Item("words", np.array([seen([(1.0, 0.0, 1.0)])[0]]), "here"))
    panel = Panel("across [m]", "upwards in the picture [m]", items, "from there")
    given = {"from there": (middles, 0.5, (TURN, RISE))}
    return figures.cubes(given, {"here": (1.0, 0.0, 1.0)}), [panel]


TestDrawn = proofs(figures, {"slices": slices, "cubes": cubes})


def test_near_cubes_are_drawn_over_far_ones():
    """The last face drawn is of the cube that is nearest, whichever order they come in."""
    rng = np.random.default_rng(0)
    middles = 0.5 * rng.permutation(np.stack(np.meshgrid(*[np.arange(3)] * 3), -1).reshape(-1, 3))
    middles = middles[rng.random(27) < 0.6]
    fig = figures.cubes({"all": (middles, 0.5, (TURN, RISE))})
    paths = fig.axes[0].collections[0].get_paths()
    nearest = middles[np.argmax(middles @ [np.cos(TURN), np.sin(TURN), np.tan(RISE)])]
    assert np.abs(paths[-1].vertices.mean(axis=0) - seen([nearest])[0]).max() < 0.5


def test_colour_tells_the_height():
    middles = np.array([(0.0, 0.0, 0.25), (2.0, 0.0, 2.25)])
    fig = figures.cubes({"all": (middles, 0.5, (TURN, RISE))})
    colours = fig.axes[0].collections[0].get_facecolors()
    assert len(colours) == 6 and len(np.unique(colours.round(3), axis=0)) == 6


def test_bad_figures_say_why():
    for call, words in [
        (lambda: figures.slices({}, "", ""), "needs a panel"),
        (lambda: figures.slices({"a": ([0, 1], [0, 1], [[1, 2]])}, "", ""), "shape"),
        (lambda: figures.cubes({}), "needs a panel"),
        (lambda: figures.cubes({"a": ([[0, 0, 0]], 0.1, (0, 1))}, columns=2), "divide the 1"),
        (lambda: figures.cubes({"a": ([[0, 0]], 0.1, (0, 1))}), "middles"),
        (lambda: figures.cubes({"a": ([[0, 0, 0]], 0.0, (0, 1))}), "edge"),
    ]:
        with pytest.raises(ValueError, match=words):
            call()

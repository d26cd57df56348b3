"""What the figures of lesson 11b show is what they were given."""

from dataclasses import replace

import numpy as np
import pytest

from backhoe.arm.kinematics import forward_kinematics
from backhoe.lessons.planning.figures import spilling as figures
from backhoe.simulation.scene import LOADING
from drawn import Panel, box, ellipse, line, proofs, track, upright


def ways():
    """The teeth by forward kinematics; the pitch by the tip frame's own x axis."""
    rng = np.random.default_rng(0)
    postures = {
        "one": np.c_[rng.uniform(-1.5, 0, 5), rng.uniform(-0.3, 0.3, (5, 3))],
        "two": np.c_[rng.uniform(-1.5, 0, 3), rng.uniform(-0.3, 0.3, (3, 3))],
    }
    scene = replace(LOADING, truck=replace(LOADING.truck, x=1.0))
    fig = figures.ways(postures, scene, (-3.2, -3.0))
    heap, truck = scene.heaps[0], scene.truck
    half, wide = truck.bed_length / 2 + 0.09, truck.bed_width / 2 + 0.09
    x, y = truck.x, truck.y
    outlines = [
        (x - half, y - wide, x + half, y + wide),
        (x - half, y + wide - 0.09, x + half, y + wide),
        (x - half, y - wide, x + half, y - wide + 0.09),
        (x + half - 0.09, y - wide, x + half, y + wide),
        (x - half, y - wide, x - half + 0.09, y + wide),
        (x + half + 0.36, y - wide + 0.09, x + half + 0.36 + 1.75, y + wide - 0.09),
    ]
    left = [ellipse((heap.x, heap.y), 2 * heap.radius, 2 * heap.radius)]
    left += [box(*outline) for outline in outlines]
    right = [box(0, np.degrees(-3.2), 1, np.degrees(-3.0))]
    for label, q in postures.items():
        T = forward_kinematics(q)
        left.append(track(T[:, :2, 3], label))
        across = T[:, 0, 0] * -np.sin(q[:, 0]) + T[:, 1, 0] * np.cos(q[:, 0])
        angle = np.degrees(np.arctan2(T[:, 2, 0], across))
        right.append(line(np.degrees(q[:, 0]), np.where(angle > 0, angle - 360, angle)))
    return fig, [
        Panel("$x$ [m]", "$y$ [m]", left),
        Panel("swing [deg], heap at -90, truck at 0", "pitch of the bucket [deg]", right),
    ]


def judged():
    results = {"here": [[1.0, 0.2], [3.0, -0.1]], "there": [[500.0, 0.4], [20.0, 0.5]]}
    fig = figures.judged(results)
    panels = []
    for column, label in enumerate(("spilled [l]", "least clearance [m]")):
        items = [line(np.array(rows)[:, column], [k, k]) for k, rows in enumerate(results.values())]
        panels.append(Panel(label, "", items + column * [upright(0.0)]))
    assert [tick.get_text() for tick in fig.axes[0].get_yticklabels()] == list(results)
    return fig, panels


TestDrawn = proofs(figures, {"ways": ways, "judged": judged})


@pytest.mark.parametrize(
    "draw, words",
    [
        (lambda: figures.ways({}, LOADING, (0, 1)), "at least one way"),
        (lambda: figures.ways({"one": [[0, 0, 0]]}, LOADING, (0, 1)), "joint angles"),
        (lambda: figures.judged({}), "at least one planner"),
        (lambda: figures.judged({"one": [1.0, 2.0]}), "litres"),
    ],
)
def test_bad_input_is_named(draw, words):
    with pytest.raises(ValueError, match=words):
        draw()

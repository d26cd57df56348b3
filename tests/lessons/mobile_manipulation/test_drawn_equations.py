"""What the figures of lesson 12a show is what they were given."""

import numpy as np
from numpy.testing import assert_allclose

from backhoe.lessons.mobile_manipulation.figures import equations as figures
from backhoe.whole_body import SlidesRobot, hand
from drawn import Panel, arrow, level, proofs, track, words

ROBOT = SlidesRobot(0.3, 0.5, 0.4, 0.35)
POSTURES = np.array([[0.2, -0.1, 0.4, 0.5, 0.7, -0.9], [0.5, 0.3, -1.2, -0.4, 1.1, -0.2]])


def turned(q, points):
    """Points of the platform in the world, by complex numbers."""
    z = complex(*q[:2]) + np.exp(1j * q[2]) * (np.array(points) @ [1, 1j])
    return np.c_[z.real, z.imag]


def joints(q):
    """Deck, shoulder and elbow from the slides' angles, and the library's hand."""
    q1, q2 = q[3:5]
    away = 0.4 * np.cos(q2) * np.exp(1j * q1)
    above = turned(q, [[0.3, 0], [0.3, 0], [0.3 + away.real, away.imag]])
    return np.vstack([np.c_[above, [0.2, 0.5, 0.5 + 0.4 * np.sin(q2)]], hand(q, ROBOT)])


def platform(q):
    corners = [[-0.15, -0.16], [0.4, -0.16], [0.4, 0.16], [-0.15, 0.16], [-0.15, -0.16]]
    above = turned(q, corners)
    low, high = above[:, 0].min(), above[:, 0].max()
    side = [[low, 0.05], [high, 0.05], [high, 0.2], [low, 0.2], [low, 0.05]]
    return above, np.array(side)


def views():
    path = np.array([[0.0, 0.1, 0.6], [0.4, 0.2, 0.7], [0.9, 0.0, 0.5]])
    arrows = {"$u$": np.array([0.2, 0.1, 0.0]), "up": np.array([0.0, 0.0, 0.3])}
    scenes = {"before": POSTURES[:1], "both": POSTURES}
    fig = figures.views(scenes, path, arrows, ROBOT)
    panels = []
    for k, (rows, label) in enumerate((([0, 1], "$y$ [m]"), ([0, 2], "$z$ [m]"))):
        items = []
        for name, postures in scenes.items():
            for q in postures:
                last = name if q is postures[-1] or len(postures) == 1 else None
                items += [track(platform(q)[k]), track(joints(q)[:, rows], last)]
        items.append(track(path[:, rows], "path"))
        start = hand(POSTURES[0], ROBOT)[rows]
        seen = [a[rows] for a in arrows.values() if np.linalg.norm(a[rows]) > 0.02]
        items += [arrow(start, start + a) for a in seen]
        items += [level(0.0)] * k
        panels.append(Panel("$x$ [m]", label, items, ("from above", "from the side")[k]))
    assert len({text.get_color() for text in fig.axes[0].lines if text.get_label() == "both"}) == 1
    return fig, panels


def solutions():
    row, b, v0 = np.array([1.0, -0.5]), 0.25, np.array([0.3, 0.4])
    least = np.array([0.2, -0.1])  # 0.25 (1, -0.5) / 1.25
    along = np.array([0.5, 1.0]) / 1.25**0.5
    nearest = least + along * (0.55 / 1.25**0.5)
    size = 1.25 * np.hypot(0.42, 0.34)  # the nearest is the longest of the three
    turn = np.linspace(0, 2 * np.pi, 73)
    fig = figures.solutions(row, b, v0, ("$u$ [m/s]", "$\\omega$ [rad/s]"))
    items = [
        track([least - 2 * size * along, least + 2 * size * along], "all solutions"),
        track(0.05**0.5 * np.c_[np.cos(turn), np.sin(turn)], "as large as the least"),
        track([(0, 0), least], "least solution"),
        track([least, nearest], "what is left of $v_0$"),
        track([v0, nearest], "from $v_0$, square on"),
        words("$v_0$  ", v0),
    ]
    return fig, [Panel("$u$ [m/s]", "$\\omega$ [rad/s]", items, clipped=True)]


TestDrawn = proofs(figures, {"views": views, "solutions": solutions})


def test_the_solutions_solve_and_v0_is_met_square_on():
    fig, _ = solutions()
    line, _, _, rest, square = (drawn.get_xydata() for drawn in fig.axes[0].lines)
    assert_allclose(line @ [1.0, -0.5], 0.25)
    assert_allclose(np.diff(rest, axis=0) @ np.diff(square, axis=0).T, 0, atol=1e-12)

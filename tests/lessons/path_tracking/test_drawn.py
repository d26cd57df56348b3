"""What the figures of lesson 05 show is what they were given."""

import numpy as np

from backhoe.lessons.path_tracking import figures
from backhoe.vehicle import tracking
from drawn import Panel, arrow, ellipse, proofs, shape, track, words

POSE = np.array([0.3, 0.2, 0.2])
PATH = np.array([(-0.5, 0.1), (0.9, 0.2), (2.0, 1.2)])


def turned(theta):
    return np.array([(np.cos(theta), np.sin(theta)), (-np.sin(theta), np.cos(theta))])


def vehicle(length):
    """A box with a nose, about the pose."""
    box = np.array([(-1, -0.6), (1, -0.6), (1, 0.6), (-1, 0.6)]) * length / 2
    nose = np.array([(0.35, 0.3), (0.35, -0.3), (0.95, 0.0)]) * length / 2
    return [shape(part @ turned(POSE[2]) + POSE[:2]) for part in (box, nose)]


def measured(start, end, text):
    return [arrow(start, end), words(text, (np.add(start, end)) / 2)]


def middle_of(centre, start, end, radius):
    half = (start + end) / 2
    return np.add(centre, 1.22 * radius * np.array([np.cos(half), np.sin(half)]))


def erred():
    here, there = np.array([2.4, 1.5]), np.array([3.3, 2.9])
    rho, dy, alpha = tracking.pose_errors(POSE, here, there)
    ahead, left = turned(POSE[2])
    place, bearing = POSE[:2], np.arctan2(*(here - POSE[:2])[::-1])
    foot = here - dy * left
    reach, size = 1.08 * np.linalg.norm(foot - place), 0.5 * np.linalg.norm(there - here)
    angle = np.degrees((POSE[2], bearing, POSE[2] + alpha))
    assert np.isclose(np.linalg.norm(here - place), rho)
    items = [
        *vehicle(0.5),
        track([here, there]), track([here, there]),
        words("$WP_n$", here), words("$WP_{n+1}$", there),
        *measured(place, here, r"$\rho$"), *measured(foot, here, r"$\Delta y$"),
        track([place, place + reach * ahead]), words("$x$ of the vehicle", place + reach * ahead),
        ellipse(place, 1.6, 1.6, 0, angle[0], angle[1]),
        words(r"$\beta$", middle_of(place, POSE[2], bearing, 0.8)),
        track([here, here + 1.3 * size * ahead]),
        ellipse(here, 2 * size, 2 * size, 0, angle[0], angle[2]),
        words(r"$\alpha$", middle_of(here, POSE[2], POSE[2] + alpha, size)),
    ]  # fmt: skip
    return figures.pose_errors(POSE, here, there), [Panel("$X$ [m]", "$Y$ [m]", items)]


def touched():
    run = np.array([(0.0, 0.4), (0.7, 0.6), (1.5, 0.4)])
    far = np.array([0.2, 0.4, 0.3])
    turn = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    fig = figures.nearest(run, PATH, far)
    circles = fig.axes[0].collections[0].get_paths()
    items = [track(PATH, "path"), track(PATH, "way-points"), track(run, "run")]
    for path, centre, radius in zip(circles, run, far, strict=True):
        on = np.linalg.norm(path.vertices - centre, axis=1)
        assert on.max() < 1.1 * radius
        for way in turn:
            assert np.linalg.norm(path.vertices - centre - radius * way, axis=1).min() < 1e-9
        items.append(shape(path.vertices))
    return fig, [Panel("$x$ [m]", "$y$ [m]", items)]


def pursued():
    target, foot = np.array([1.4, 0.9]), np.array([0.4, 0.16])
    ahead, left = turned(POSE[2])
    way = target - POSE[:2]
    curvature = 2 * (way @ left) / (way @ way)
    centre, radius = POSE[:2] + left / curvature, 1 / curvature
    turn = np.linspace(0.0, 2 * (np.arctan2(way[1], way[0]) - POSE[2]), 60)[:, None]
    arc = centre + radius * (np.sin(turn) * ahead - np.cos(turn) * left)
    beside = POSE[:2] + (way @ ahead) * ahead
    items = [
        *vehicle(0.35),
        track(PATH, "path"), track([POSE[:2], foot]), track(arc, "arc"),
        track([POSE[:2], beside]), *measured(target, beside, "$y_L$"),
        *measured(POSE[:2], target, "$d$"), track([foot], "nearest point"),
        track([target], "point ahead"),
    ]  # fmt: skip
    fig = figures.pursuit(POSE, PATH, foot, target, curvature)
    return fig, [Panel("$x$ [m]", "$y$ [m]", items)]


def charted():
    values = np.array([[1.0, 0.5, 0.1, 0.7], [0.2, 1.0, 1.0, 0.6]])
    one = tracking.Radar(("a", "b", "c", "d"), ("P", "PI"), values, (0.1, 0.25, 3.0, 4.0))
    other = tracking.Radar(("a", "b", "c"), ("P", "PI"), values[:, ::-1][:, :3], (1.0, 2.0, 3.0))
    fig = figures.radar({"one": one, "two": other}, {"a": "mean"})
    panels = []
    for ax, (title, chart) in zip(fig.axes, {"one": one, "two": other}.items(), strict=True):
        angle = 2 * np.pi * np.arange(len(chart.fields)) / len(chart.fields)
        closed = [
            track(np.c_[[*angle, 0.0], [*row, row[0]]], name)
            for name, row in zip(chart.trackers, chart.values, strict=True)
        ]
        panels.append(Panel("", "", closed, title))
        names = ["mean" if field == "a" else field for field in chart.fields]
        names = [f"{name}\n{one:.2g}" for name, one in zip(names, chart.scales, strict=True)]
        assert [t.get_text() for t in ax.get_xticklabels()] == names
        np.testing.assert_allclose(ax.get_xticks(), angle)
    return fig, panels


TestDrawn = proofs(
    figures, {"nearest": touched, "pose_errors": erred, "pursuit": pursued, "radar": charted}
)

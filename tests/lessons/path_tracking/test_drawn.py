"""What the figures of lesson 05 show is what they were given."""

import numpy as np

from backhoe.lessons.path_tracking.figures import blocks, comparing
from backhoe.lessons.path_tracking.figures import errors as figures
from backhoe.vehicle import tracking
from drawn import Panel, arrow, box, ellipse, faults, proofs, shape, survivors, track, words

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


def boxed():
    """Each box and its words, an arrow from each source, and the way back of what is measured."""
    names, panels = ("P", "Scaglia v3"), []
    for name in names:
        diagram = blocks.DIAGRAMS[name]
        columns = (diagram.looks, [*diagram.works], [*diagram.laws])
        left, right, items, at = (0.0, 2.4, 5.2), (1.75, 4.5, 7.65), [], {}
        for place, column in enumerate(columns):
            for k, text in enumerate(column):
                y = 2 - (2 * k + 1) / len(column)
                at[place, k] = y
                items += [box(left[place], y - 0.28, right[place], y + 0.28)]
                items += [words(text, ((left[place] + right[place]) / 2, y))]
        for place, needs in enumerate((diagram.works.values(), diagram.laws.values())):
            for k, sources in enumerate(needs):
                for source in sources:
                    start = right[place], at[place, source]
                    items += [arrow(start, (left[place + 1], at[place + 1, k]))]
        for k, text in enumerate(("$v$", r"$\omega$")):
            items += [
                arrow((7.65, at[2, k]), (8.35, at[2, k])),
                words(text, (7.95, at[2, k] + 0.08)),
            ]
        items += [box(8.35, 0, 9.3, 2), words("limits", (8.825, 1)), arrow((9.3, 1), (9.75, 1))]
        items += [box(9.75, 0, 10.85, 2), words("vehicle", (10.3, 1))]
        lowest = at[0, len(diagram.looks) - 1] - 0.28
        items += [track([(10.3, 0), (10.3, -0.55), (0.875, -0.55)]), words("measured", (5.2, -0.5))]
        items += [arrow((0.875, -0.55), (0.875, lowest))]
        panels.append(Panel("", "", items, name))
    return blocks.controllers(names), panels


def test_the_boxes_of_controllers_are_drawn_and_none_else():
    fig, panels = boxed()
    for ax in fig.axes:
        ax.axison = True
    assert not faults(fig, panels)
    assert not survivors(fig, panels)[1]


def test_an_arrow_starts_at_each_box_that_is_looked_at_or_worked_out():
    for diagram in blocks.DIAGRAMS.values():
        for column, needs in ((diagram.looks, diagram.works), (diagram.works, diagram.laws)):
            used = {source for sources in needs.values() for source in sources}
            assert used == set(range(len(column)))


def measured_twice():
    path = {name: tracking.square(side) for name, side in (("small", 1.0), ("large", 2.0))}
    trackers = {name: tracking.TRACKERS[name]() for name in ("P", "pure pursuit")}
    before, after = (
        tracking.compare(trackers, path, lambda dt=dt: tracking.IdealPlant(dt))
        for dt in (0.05, 0.1)
    )
    fields = {"d_mean": ("mean [mm]", 1e3), "change_omega": ("steering [rad/s]", 1.0)}
    panels = []
    for row, title in enumerate(path):
        for field, (label, unit) in fields.items():
            items = []
            for k in range(2):
                one, other = (unit * each.values[field][row, k] for each in (before, after))
                items += [track([(one, k), (other, k)]), track([(one, k)]), track([(other, k)])]
            panels.append(Panel(label, "tracker", items, title if field == "d_mean" else ""))
    fig = comparing.measures(before, after, fields)
    assert [t.get_text() for t in fig.axes[0].get_yticklabels()] == ["P", "pure pursuit"]
    return fig, panels


TestDrawn = proofs(figures, {"nearest": touched, "pose_errors": erred, "pursuit": pursued})
TestCompared = proofs(comparing, {"measures": measured_twice})

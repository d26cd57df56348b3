"""The figures of lesson 05: what they show is what was computed, and bad input is refused."""

import numpy as np
import pytest
from matplotlib.patches import Arc

from backhoe.lessons.path_tracking.figures import blocks, comparing
from backhoe.lessons.path_tracking.figures import errors as figures
from backhoe.vehicle import tracking
from backhoe.view import plots

POSE = np.array([0.3, 0.2, 0.2])
WAYPOINT, NEXT = np.array([2.4, 1.5]), np.array([3.3, 2.9])


def compared(*names):
    path = {"line": tracking.from_points([(0, 0), (1, 0)])}
    return [
        tracking.compare({name: tracking.TRACKERS[name]()}, path, tracking.IdealPlant)
        for name in names
    ]


def lines_of(ax):
    return {line.get_label(): line.get_xydata() for line in ax.lines}


def test_the_arcs_in_the_picture_of_the_errors_span_beta_and_alpha():
    ax = figures.pose_errors(POSE, WAYPOINT, NEXT).axes[0]
    rho, dy, alpha = tracking.pose_errors(POSE, WAYPOINT, NEXT)
    spans = [np.radians(arc.theta2 - arc.theta1) for arc in ax.patches if isinstance(arc, Arc)]
    assert spans == pytest.approx([np.arcsin(dy / rho), alpha])


def test_the_arrow_of_delta_y_is_as_long_as_delta_y():
    ax = figures.pose_errors(POSE, WAYPOINT, NEXT).axes[0]
    arrows = [note for note in ax.texts if getattr(note, "arrowprops", None)]
    lengths = [np.linalg.norm(np.subtract(note.xy, note.xyann)) for note in arrows]
    rho, dy, _ = tracking.pose_errors(POSE, WAYPOINT, NEXT)
    assert lengths == pytest.approx([rho, abs(dy)])


def test_from_above_draws_each_scene_in_its_panel_with_one_colour_a_label():
    square, circle = tracking.square(2.0).points, tracking.circle(1.0).points
    scenes = {
        "square": {"path": square, "P": square + 0.1},
        "circle": {"path": circle, "PI": circle + 0.1, "P": circle + 0.2},
    }
    fig = plots.from_above(scenes, marks={"start": [[0.0, 0.0]]})
    assert [ax.get_title() for ax in fig.axes] == list(scenes)
    first, second = fig.axes
    np.testing.assert_array_equal(lines_of(first)["P"], square + 0.1)
    np.testing.assert_array_equal(lines_of(second)["PI"], circle + 0.1)
    colours = [
        {line.get_label(): line.get_color() for line in ax.lines}["P"] for ax in (first, second)
    ]
    assert colours[0] == colours[1]
    names = [text.get_text() for text in fig.legends[0].get_texts()]
    assert sorted(names) == ["P", "PI", "path", "start"]


def test_from_above_leaves_no_empty_axes_beside_an_odd_number_of_scenes():
    circle = {"path": tracking.circle(1.0).points}
    fig = plots.from_above({"a": circle, "b": circle, "c": circle}, columns=2)
    assert [ax.axison for ax in fig.axes] == [True, True, True, False]


def test_the_circles_about_a_run_have_its_distances_as_radii():
    path = tracking.from_points([(0.0, 0.0), (2.0, 1.0)])
    run = np.column_stack((np.linspace(0.0, 2.0, 9), np.zeros(9)))
    distances = tracking.distances(run, path.points)
    circles = figures.nearest(run, path.points, distances).axes[0].collections[0].get_paths()
    radii = [np.ptp(outline.vertices[:, 0]) / 2 for outline in circles]
    assert radii == pytest.approx(distances, abs=1e-6)


@pytest.mark.parametrize("pose", [(0.0, 0.4, -0.3), (0.2, -0.5, 1.9), (3.0, 1.0, -2.8)])
def test_the_arc_of_pure_pursuit_leaves_ahead_and_ends_on_its_point(pose):
    pose, path = np.array(pose), np.array([[-0.5, 0.0], [0.8, 0.0], [2.0, 1.0]])
    target = np.array([1.2, 1 / 3])
    dx, dy = target - pose[:2]
    aside = -np.sin(pose[2]) * dx + np.cos(pose[2]) * dy
    curvature = 2 * aside / (dx**2 + dy**2)
    arc = lines_of(figures.pursuit(pose, path, (0.2, 0.0), target, curvature).axes[0])["arc"]
    np.testing.assert_allclose(arc[[0, -1]], [pose[:2], target], atol=1e-9)
    first = arc[1] - arc[0]
    assert first @ (np.cos(pose[2]), np.sin(pose[2])) > 0.9 * np.linalg.norm(first)


def test_a_straight_pursuit_is_a_straight_line():
    ax = figures.pursuit((0, 0, 0), [(0, 0), (2, 0)], (0, 0), (1, 0), 0.0).axes[0]
    np.testing.assert_allclose(lines_of(ax)["arc"], [(0, 0), (1, 0)])


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda: figures.pose_errors((0, 0), WAYPOINT, NEXT), r"pose must have shape \(3,\)"),
        (lambda: figures.pose_errors(POSE, (0, np.nan), NEXT), "waypoint must be finite"),
        (lambda: plots.from_above({}), "nothing to draw"),
        (lambda: plots.from_above({"a": {"path": [1.0, 2.0]}}), "path must be rows of x, y"),
        (
            lambda: figures.nearest([[0, 0]], [[0, 0], [1, 0]], [1, 2]),
            r"distances must have shape \(1,\)",
        ),
        (
            lambda: figures.pursuit(POSE, [[0, 0], [1, 0]], (0, 0), (1,), 0.0),
            r"target must have shape \(2,\)",
        ),
        (lambda: blocks.controllers([]), "name a controller"),
        (lambda: blocks.controllers(["PD"]), "controller must be one of P, PI"),
        (lambda: comparing.measures(*compared("P", "PI"), {}), "the same trackers"),
        (lambda: comparing.measures(*compared("P", "P"), {"area": ("a", 1.0)}), "no field called"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()

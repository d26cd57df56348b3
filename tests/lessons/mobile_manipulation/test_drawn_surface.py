"""What the figures of graded ground show is what they were given."""

from math import cos, radians, sin

import numpy as np
import pytest

from backhoe.lessons.mobile_manipulation.figures import surface as figures
from drawn import Panel, box, cells, line, proofs

X, Y = np.array([1.0, 1.5, 2.0]), np.array([-1.0, -0.5])
ERRORS = {"one": [[0.02, np.nan, 0.3], [-0.04, 0.2, 0.06]], "other": [[0.0, 0.0, 0.01]] * 2}


def edges(middles):
    half = np.diff(middles)[0] / 2
    return np.append(middles - half, middles[-1] + half)


def error_map():
    fig = figures.error_map(X, Y, ERRORS, tolerance=0.05)
    titles = ["one: 40.0 % within 5 cm", "other: 100.0 % within 5 cm"]
    return fig, [
        Panel(
            "$x$ [m]",
            "" if k else "$y$ [m]",
            [cells(edges(X), edges(Y), np.array(values))],
            titles[k],
        )
        for k, values in enumerate(ERRORS.values())
    ]


def surface_3d(turn_deg=200, rise_deg=40):
    """A plane: its corners stand where the eye's two axes say, the far ones first."""
    turn, rise = radians(turn_deg), radians(rise_deg)
    x, y = np.array([1.0, 1.5, 2.0, 2.5]), np.array([-1.0, -0.6, -0.2])
    z = 0.3 * x + 0.2 * y[:, None] - 0.1
    errors = np.arange(12.0).reshape(3, 4) / 100
    errors[0, 1] = np.nan
    fig = figures.surface_3d(x, y, {"a": (z, errors), "b": (0 * z, errors)}, turn, rise)
    light = 1 / np.sqrt(1 + (0.3 + 0.8 * cos(turn)) ** 2 + (0.2 + 0.8) ** 2)
    flat = 1 / np.sqrt(1 + (0.8 * cos(turn)) ** 2 + 0.8**2)
    eye = np.array([cos(rise) * cos(turn), cos(rise) * sin(turn), sin(rise)])
    right = np.array([-sin(turn), cos(turn), 0.0])
    panels = []
    for title, tilt, shade in (("a", (0.3, 0.2, -0.1), light), ("b", (0, 0, 0), flat)):
        cx, cy = np.meshgrid(edges(x), edges(y))
        points = np.stack([cx, cy, tilt[0] * cx + tilt[1] * cy + tilt[2]], axis=-1)
        seen = points @ right, points @ np.cross(eye, right)
        far_first = np.s_[:: 1 if sin(turn) > 0 else -1, :: 1 if cos(turn) > 0 else -1]
        items = []
        for values in (np.full((3, 4), shade), errors):
            parts = [part[far_first].ravel() for part in (*seen, values)]
            items.append(
                cells([0, 1], [0, 1], np.zeros((1, 1)))._replace(data=np.concatenate(parts))
            )
        y_label = "" if title == "b" else "upwards in the picture [m]"
        panels.append(Panel("across the view [m]", y_label, items, title))
    return fig, panels


def trench_section():
    across = np.linspace(-1.0, 1.0, 5)
    near, far = np.array([0.0, -0.1, -0.41, -0.2, 0.0]), np.array([0.0, -0.2, -0.38, -0.1, 0.0])
    fig = figures.trench_section(across, {"near": near, "far": far}, 0.8, -0.4, 0.05)
    ax = fig.axes[0]
    assert ax.get_xlim()[0] > ax.get_xlim()[1]
    items = [
        line(across, near, "near"),
        line(across, far, "far"),
        line([-0.4, 0.4], [-0.4, -0.4], "design, ±5 cm"),
        box(-0.4, -0.45, 0.4, -0.35),
    ]
    return fig, [Panel("across, left is positive [m]", "$z$ [m]", items)]


TestDrawn = proofs(
    figures,
    {
        "error_map": error_map,
        "surface_3d": surface_3d,
        "surface_3d from the front": lambda: surface_3d(-30, 25),
        "trench_section": trench_section,
    },
)


def test_errors_beyond_the_tolerance_have_other_colours():
    fig = figures.error_map(X, Y, ERRORS, tolerance=0.05)
    mesh = fig.axes[0].collections[0]
    colour = lambda error: mesh.cmap(mesh.norm(error))  # noqa: E731
    assert colour(0.049) == colour(0.03) != colour(0.051) != colour(0.11)
    assert colour(-0.049) != colour(-0.051)
    assert colour(0.3) != colour(-0.3)


def test_a_map_without_errors_is_refused():
    with pytest.raises(ValueError, match="no cell of 'empty'"):
        figures.error_map(X, Y, {"empty": np.full((2, 3), np.nan)})
    with pytest.raises(ValueError, match="at least one panel"):
        figures.surface_3d(X, Y, {}, 0.0, 0.5)

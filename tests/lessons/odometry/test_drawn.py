"""What the figures of lesson 06 show is what they were given."""

import numpy as np

from backhoe.lessons.odometry import figures
from drawn import Panel, arrow, ellipse, line, proofs, shape, track, words

T, V = np.array([0.0, 0.5, 1.2, 1.6]), np.array([0.2, 0.7, 0.4, 0.9])
X, Y = "$x$ [m]", "$y$ [m]"


def speed(t):
    return 0.3 + t**2


def summed():
    fine = np.linspace(0.0, 1.6, 400)
    panels = []
    for title in ("Euler: rectangles", "bilinear: trapezoids"):
        items = [line(fine, speed(fine), "speed"), line(T, V, "samples")]
        for k in range(3):
            first = V[k + 1] if title[0] == "E" else V[k]
            corners = [(T[k], 0), (T[k], first), (T[k + 1], V[k + 1]), (T[k + 1], 0)]
            items.append(shape(corners))
        panels.append(Panel("time [s]", "speed [m/s]", items, title))
    return figures.areas(T, V, speed), panels


def orders():
    steps = np.array([0.1, 0.2, 0.4])
    items = []
    errors = {"first": 3 * steps, "second": 0.5 * steps**2}
    for order, (label, values) in enumerate(errors.items(), start=1):
        guide = 2.2 * values
        items += [line(steps, values, label), line(steps, guide)]
        items.append(words(f"slope {order}", (0.1, guide[0])))
    fig = figures.error_orders(steps, errors)
    return fig, [Panel("time step [s]", "error at the end [m]", items, scales=("log", "log"))]


def stepped():
    pose = np.array([0.2, 0.1, 0.6])
    arc = np.array([pose, [1.0, 0.9, 0.9], [1.4, 1.9, 1.2]])
    ends = {"Euler": (1.8, 0.9, 1.2), "midpoint": (1.5, 1.8, 1.2)}
    items = [track(arc[:, :2], "true arc")]
    for label, end in ends.items():
        items.append(track([pose[:2], end[:2]], label))
    size = 0.08 * 1.8
    ahead, left = np.array([(np.cos(0.6), np.sin(0.6)), (-np.sin(0.6), np.cos(0.6))])
    outline = [(-1.0, -0.7), (-1.0, 0.7), (0.2, 0.7), (0.9, 0.0), (0.2, -0.7)]
    items.append(shape([pose[:2] + size * (a * ahead + b * left) for a, b in outline]))
    return figures.one_step(pose, arc, ends), [Panel(X, Y, items)]


def ended():
    given = {
        "one": {"cw": [(0.1, 0.2), (0.3, 0.5)], "ccw": [(0.0, -0.1), (-0.2, -0.3)]},
        "two": {"cw": [(0.4, 0.1), (0.2, 0.3)], "ccw": [(0.1, -0.2)]},
    }
    panels = []
    for title, groups in given.items():
        items = [line(0.0, 0.0, "start")]
        for label, places in groups.items():
            items += [track(places, label), track([np.mean(places, axis=0)])]
        panels.append(Panel(X, Y, items, title))
    return figures.end_places(given), panels


def rolled():
    given = {
        "two": [(0.1, 0.3, 0.2, np.nan), (0.0, -0.3, 0.0, np.nan)],
        "rollers": [(0.4, 0.0, np.pi / 2, 0.3)],
    }
    panels = []
    for title, wheels in given.items():
        reach = max(np.hypot(x, y) for x, y, *_ in wheels)
        ways = [((0.0, 0.0), (0.6 * reach, 0.0))]
        items = [ellipse((0, 0), 1.44 * reach, 1.44 * reach)]
        for x, y, drive, free in wheels:
            at = np.array([x, y])
            along = np.array([np.cos(drive), np.sin(drive)])
            across = np.array([-np.sin(drive), np.cos(drive)])
            ways.append((at, at + 0.62 * reach * along))
            items.append(
                shape(
                    [
                        at + reach * (a * along + b * across)
                        for a in (-0.2, 0.2)
                        for b in (-0.08, 0.08)
                    ]
                )
            )
            if not np.isnan(free):
                slide = 0.4 * reach * np.array([np.cos(free), np.sin(free)])
                ways += [(at, at + slide), (at, at - slide)]
        items += [arrow(*way) for way in ways] + [track(way) for way in ways]
        label = "$y$ to the left [m]"
        panels.append(Panel("$x$ forward [m]", label, items, title, clipped=True))
    fig = figures.wheeled(given)
    named = {text.get_text() for text in fig.legends[0].get_texts()}
    assert named == {"drives", "slides freely", "ahead"}
    return fig, panels


TestDrawn = proofs(
    figures,
    {
        "areas": summed,
        "end_places": ended,
        "error_orders": orders,
        "one_step": stepped,
        "wheeled": rolled,
    },
)

"""What the figures of lesson 07 show is what they were given."""

import numpy as np

from backhoe.lessons.ekf import figures
from drawn import Panel, box, line, proofs, shape, track, tunnel

T = np.array([0.0, 1.0, 2.5, 4.0])
X, Y = "$x$ [m]", "$y$ [m]"
POSES = np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.4], [1.8, 1.4, 0.9], [2.0, 2.6, 1.4]])
P = np.array([[0.09, 0.02, 0.0], [0.02, 0.04, 0.0], [0.0, 0.0, 0.01]])
LOGARITHMIC = ("linear", "log")


def around(mean, covariance):
    """Outline that holds 95 %: a circle of radius sqrt(-2 ln 0.05) through the root of P."""
    values, vectors = np.linalg.eigh(np.asarray(covariance)[:2, :2])
    turn = np.linspace(0, 2 * np.pi, 60)
    circle = np.sqrt(-2 * np.log(0.05)) * np.stack((np.cos(turn), np.sin(turn)))
    return np.asarray(mean)[:2] + (vectors @ (np.sqrt(values)[:, None] * circle)).T


def beliefs():
    given = {"before": [0.5, 0.4, 0.1], "after": [0.1, 0.8, 0.15]}
    panels = []
    for row, (title, values) in enumerate(given.items()):
        items = [box(k - 0.4, 0.0, k + 0.4, value) for k, value in enumerate(values)]
        items += [box(1.5, 0.0, 2.5, 1.0), line(row, 0.9 * 1.15 * 0.8)]
        panels.append(Panel("place [1]", "belief [1]", items, title))
    return figures.beliefs(given, there=[0, 1], marked=[2]), panels


def tunnels():
    deviation, errors, many = 0.1 + T / 10, T / 20, np.outer([0.1, -0.2], T)
    given = {
        "x [m]": {"one": (errors, deviation), "two": (-errors, 2 * deviation)},
        "y [m]": {"runs": (many, deviation)},
    }
    upper = [tunnel(T, -2 * deviation, 2 * deviation), line(T, errors, "one")]
    upper += [tunnel(T, -4 * deviation, 4 * deviation), line(T, -errors, "two")]
    lower = [tunnel(T, -2 * deviation, 2 * deviation), line(T, many[0], "runs"), line(T, many[1])]
    return figures.tunnels(T, given), [
        Panel("time [s]", "x [m]", upper),
        Panel("time [s]", "y [m]", lower),
    ]


def honest():
    fig = figures.consistency(
        {"a": T, "b": T[:3]}, {"a": 1 + T, "b": 9 - T[:3]}, (2.4, 3.7), "NEES [1]"
    )
    items = [box(0.0, 2.4, 1.0, 3.7), line(T, 1 + T, "a"), line(T[:3], 9 - T[:3], "b")]
    return fig, [Panel("time [s]", "NEES [1]", items, scales=LOGARITHMIC)]


def drives():
    covariances = np.arange(1.0, 5.0)[:, None, None] * P
    other = np.add(POSES, (0.2, -0.1, 0.0))
    given = {"filter": (other, covariances), "odometry": (POSES[:, ::-1], None)}
    items = [track(POSES[:, :2], "truth")]
    items += [track(other[:, :2], "filter"), track(POSES[:, :0:-1], "odometry")]
    for mark in (1, 3):
        outline = around(other[mark], covariances[mark])
        items += [shape(outline), track(outline)]
    fig = figures.drives_with_ellipses(POSES, given, [1, 3], title="there")
    return fig, [Panel(X, Y, items, "there")]


def clouds():
    given = {"EKF": (POSES[0], P), "UKF": (POSES[1], 2 * P)}
    items = [track(POSES[:, :2], "particles")]
    for name, (mean, covariance) in given.items():
        outline = around(mean, covariance)
        items += [shape(outline), track(outline), track([mean[:2]], f"{name}, 95 %")]
    return figures.clouds(POSES, given, title="there"), [Panel(X, Y, items, "there")]


def promises():
    given = {"free": (0.1 + T, 0.2 + T), "fixed": (0.1 * T, 0.3 - 0.05 * T)}
    panels = [
        Panel("time [s]", "sigma [m]", [line(T, one, "happened"), line(T, other, "claimed")], name)
        for name, (one, other) in given.items()
    ]
    return figures.promises(T, given, "sigma [m]"), panels


TestDrawn = proofs(
    figures,
    {
        "beliefs": beliefs,
        "clouds": clouds,
        "consistency": honest,
        "drives_with_ellipses": drives,
        "promises": promises,
        "tunnels": tunnels,
    },
)

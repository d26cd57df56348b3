"""What the figures of lesson 02 show is what they were given, and what the dynamics say."""

import numpy as np

from backhoe.arm import dynamics, kinematics
from backhoe.lessons.dynamics import bench, figures
from backhoe.machine import BACKHOE
from backhoe.machine.variants import loaded, reading
from backhoe.view.plots.drawing import draw_arm, side_axes
from drawn import Panel, arrow, box, field, line, part, proofs, track, upright, words

Q = np.radians([-50.0, 15.0, -10.0, 40.0])
FALL = np.array([Q, Q - 0.1, Q - 0.25])
REACH, HEIGHT = "distance from the swing axis [m]", "height above the ground [m]"
SHIFT = BACKHOE.base.offset
LINKS = ("boom", "stick", "bucket")


def in_plane(q, frames, machine=BACKHOE):
    at = np.array([kinematics.forward_kinematics(q, f, machine=machine)[:3, 3] for f in frames])
    return np.c_[np.hypot(at[:, 0] - SHIFT, at[:, 1]), at[:, 2]]


def joints(q):
    return in_plane(q, ("swing", "boom", "stick", "tip"))


def centres(q, machine=BACKHOE):
    return in_plane(q, [f"{name}_com" for name in LINKS], machine)


def scene(limits, q=None, machine=BACKHOE, body=BACKHOE):
    items = part(lambda ax: side_axes(ax, limits, body))
    return items if q is None else items + part(lambda ax: draw_arm(ax, q, machine))


def weighed():
    items = scene((-2.6, 8.2, -1.4, 5.4), Q)
    start = joints(Q)[0, 0]
    items.append(line((start, start), (-1.4, joints(Q)[0, 1])))
    for row, (name, at) in enumerate(zip(LINKS, centres(Q), strict=True)):
        weight = getattr(BACKHOE, name).mass * BACKHOE.gravity
        under = -0.35 - 0.36 * row
        items += [
            arrow(at, at - (0, 0.35 + weight / 3e4)),
            track([at]),
            words(f"{name} {weight / 1e3:.1f} kN", np.add(at, (0.15, 0.22))),
            line((at[0], at[0]), (at[1], under)),
            arrow((start, under), (at[0], under)),
            words(f"{at[0] - start:.2f} m", ((at[0] + start) / 2, under)),
        ]
    return figures.weights(Q), [Panel(REACH, HEIGHT, items)]


def mapped():
    """Inverse kinematics turns each place of an edge into the posture, which has that torque."""
    fig = figures.gravity_map(2)
    drawn = {t.get_text(): t.get_position() for t in fig.axes[0].texts}

    def torque(reach, height):
        some = slice(None, None, max(1, len(reach) // 40))
        target = np.column_stack((SHIFT + reach, 0 * reach, height, 0 * reach))[some]
        q = kinematics.inverse_kinematics(target, elbow="up", limits=False, on_failure="nan")
        found = ~np.isnan(q).any(axis=1)
        q = np.where(found[:, None], q, 0.0) * (0, 1, 1, 0)
        return np.where(found, dynamics.gravity_torque(q)[:, 2] / 1e3, np.nan)

    items = [
        *scene((-2.6, 8.2, -4.4, 8.0), np.radians([0.0, 20.0, 0.0, 0.0])),
        field(torque, 0.3), field(torque, 0.3), *(words(*one) for one in drawn.items()),
    ]  # fmt: skip
    title = "torque that holds the stick, pin at this place"
    return fig, [Panel(REACH, HEIGHT, items, title)]


def matrix(q):
    """Least eigenvalue -2 .. 2, over boom and stick alone."""
    least = np.sin(q[..., 1]) + np.cos(2 * q[..., 2]) - q[..., 3] / 5
    return np.eye(4) * np.array([1.0, 4.0, 5.0, 6.0]) + (least - 1)[..., None, None] * np.diag(
        [1.0, 0.0, 0.0, 0.0]
    )


def least():
    def values(boom, stick):
        return np.sin(np.radians(boom)) + np.cos(2 * np.radians(stick)) - np.radians(30.0) / 5

    items = [field(values, 0.01), field(values, 0.01)]
    fig = figures.least_eigenvalue(matrix, bucket=30.0)
    return fig, [Panel("boom [deg]", "stick [deg]", items, "bucket at 30 deg")]


def falling():
    arm = bench.on_a_stand()
    pairs = zip(("swing", "boom", "stick"), ("boom", "stick", "tip"), strict=True)
    items = scene((-2.6, 8.8, 0.0, 6.0), body=arm)
    top = arm.base.height - 0.2
    items += [
        box(-0.5, top - 1.5, 0.5, top),
        track(in_plane(Q, ("swing", "boom", "stick", "tip"), arm)),
    ]
    items += [track(in_plane(q, ends, arm)) for ends in pairs for q in FALL[1:]]
    fig = figures.falls({"one": FALL, "two": FALL, "three": FALL})
    assert not fig.axes[3].axison
    assert [t.get_text() for t in fig.axes[3].get_legend().texts] == [*LINKS, "start"]
    titles = ("one", "two", "three")
    return fig, [Panel("reach [m]", "height [m]", items, title) for title in titles]


def candidates():
    other = reading([-1.9, -3.8, 14.1, -11.4])
    torque = dynamics.gravity_torque(Q)
    panels = []
    for title, machine in (("hang", BACKHOE), ("other", other)):
        miss = np.abs(dynamics.gravity_torque(Q, machine=machine) - torque).max() / 1e3
        items = scene((0.0, 9.4, -0.8, 4.2), Q, machine, None)
        items += [track([at]) for at in centres(Q, machine)]
        title = f"{title}\nmisses by {miss:.2f} kN m"
        panels.append(Panel("reach [m]", "height [m]", items, title, clipped=True))
    return figures.candidates({"hang": BACKHOE, "other": other}, Q, torque), panels


def held():
    q = np.radians([0.0, 10.0, -5.0, 30.0])
    rows = {"boom": 0, "stick": 0, "bucket": 1}
    bars = {name: [upright(0.0)] for name in ("boom", "stick")}
    for shift, machine in ((-0.2, BACKHOE), (0.2, loaded(2e3))):
        torques = dynamics.gravity_torque(q, machine=machine)[1:] / 1e3
        for name, torque in zip(LINKS, torques, strict=True):
            at = rows[name] + shift
            bars["boom" if name == "boom" else "stick"] += [
                box(0.0, at - 0.18, torque, at + 0.18),
                words(f"{torque:.1f}", (torque, at)),
            ]
    fig = figures.holding(10.0, -5.0, 30.0, load=2.0)
    assert [[t.get_text() for t in ax.get_yticklabels()] for ax in fig.axes[1:]] == [
        ["boom"],
        ["stick", "bucket"],
    ]
    return fig, [
        Panel(REACH, HEIGHT, scene((-2.6, 9.2, -4.4, 8.0), q)),
        Panel("holding torque [kN m]", "joint", bars["boom"], "striped: with 2 t", clipped=True),
        Panel("holding torque [kN m]", "joint", bars["stick"], clipped=True),
    ]


TestDrawn = proofs(
    figures,
    {
        "candidates": candidates,
        "falls": falling,
        "gravity_map": mapped,
        "holding": held,
        "least_eigenvalue": least,
        "weights": weighed,
    },
)

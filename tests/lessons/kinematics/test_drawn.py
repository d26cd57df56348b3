"""What the figures of lesson 01 show is what they were given, and where the kinematics say."""

import numpy as np

from backhoe.arm import kinematics
from backhoe.lessons.kinematics.figures import frames, inverse, steps
from backhoe.machine import BACKHOE
from backhoe.view.plots.drawing import draw_arm, draw_from_above, side_axes
from drawn import (
    Panel,
    arrow,
    box,
    ellipse,
    field,
    level,
    line,
    part,
    proofs,
    shape,
    track,
    words,
)

Q = np.radians([-50.0, 15.0, -10.0, 40.0])
LOW = np.radians([-90.0, -25.0, 20.0, 10.0])
REACH, HEIGHT = "distance from the swing axis [m]", "height above the ground [m]"
ARM, SHIFT = (-3.2, 9.0, -4.2, 7.2), BACKHOE.base.offset


def points(q):
    """Boom's, stick's and bucket's joint and the teeth: distance from the swing axis, height."""
    frames = ("swing", "boom", "stick", "tip")
    at = np.array([kinematics.forward_kinematics(q, frame)[:3, 3] for frame in frames])
    return np.c_[np.hypot(at[:, 0] - SHIFT, at[:, 1]), at[:, 2]]


def scene(limits, q=None):
    items = part(lambda ax: side_axes(ax, limits))
    return items if q is None else items + part(lambda ax: draw_arm(ax, q))


def two_arms():
    fig = frames.arm(Q, LOW, labels=("dig", "low"))
    return fig, [
        Panel(REACH, HEIGHT, scene(ARM, Q), "dig"),
        Panel(REACH, "", scene(ARM, LOW), "low"),
    ]


def framed():
    limits = (-2.6, 8.2, -1.6, 5.6)
    items = scene(limits, Q)
    places = np.vstack(((-SHIFT, 0.0), points(Q)))
    poses = [np.eye(4)] + [
        kinematics.forward_kinematics(Q, f) for f in ("swing", "boom", "stick", "tip")
    ]
    outwards = np.array([np.cos(Q[0] + np.pi / 2), np.sin(Q[0] + np.pi / 2), 0.0])
    for number, (place, T) in enumerate(zip(places, poses, strict=True)):
        axes = {"x": T[:3, 0], "z" if number == 0 else "y": T[:3, 2 if number == 0 else 1]}
        for letter, axis in axes.items():
            if number == 0:
                way = np.array([axis[0], axis[2]])
            else:
                way = np.array([axis @ outwards, axis[2]])
            items.append(arrow(place, place + 0.95 * way))
            items.append(words(letter, place + 1.2 * 0.95 * way))
    fig = frames.frames(Q)
    names = ["base 0", "swing 1", "boom 2", "stick 3", "tip 4"]
    shown = {text.get_text(): text.get_position() for text in fig.axes[0].texts}
    for name, place in zip(names, places, strict=True):
        np.testing.assert_allclose(np.linalg.norm(shown[name] - place), 0.28)
        items.append(words(name, shown[name]))
    return fig, [Panel(REACH, HEIGHT, items)]


def two_elbows():
    target = kinematics.pose(Q)
    limits = (-2.4, 8.4, -2.0, 6.2)
    other = kinematics.inverse_kinematics(target, elbow="down", limits=False)
    start, elbow, pin, _ = points(Q)
    low = points(other)
    assert np.linalg.norm(low[2] - pin) < 1e-9 and low[1, 1] < elbow[1]
    fig = inverse.elbows(target)
    rise, boom = (np.degrees(np.arctan2(*(p - start)[::-1])) for p in (pin, elbow))
    items = [
        *scene(limits, Q),
        track(low[:3]),
        track([start, pin]),
        line((start[0], start[0] + 3.2), (start[1], start[1])),
        ellipse(start, 5.2, 5.2, 0, *sorted((0.0, rise))),
        ellipse(start, 3.4, 3.4, 0, rise, boom),
    ]
    for text, place, far in (
        ("elbow up", elbow, 0.8), ("elbow down: outside the limits", low[1], 0.6),
        ("$d$", (start + pin) / 2, 0.3), ("$L_2$", (start + elbow) / 2, 0.8),
        ("$L_3$", (elbow + pin) / 2, 0.5), (r"$\beta$", start, 2.9), (r"$\gamma$", start, 2.0),
    ):  # fmt: skip
        shown = next(t.get_position() for t in fig.axes[0].texts if t.get_text() == text)
        assert np.linalg.norm(shown - place) < far, text
        items.append(words(text, shown))
    return fig, [Panel(REACH, HEIGHT, items)]


def reach():
    """The edges of the areas are half-way between the cells that can be entered and the others."""
    fig = frames.workspace(Q)
    side = fig.axes[0]
    items = scene((*side.get_xlim(), *side.get_ylim()), Q)
    for point in (3, 2):
        entered = frames.reachable(BACKHOE, point)

        def near(x, z, entered=entered):
            at = np.column_stack((x, z))
            gaps = [np.abs(entered - one).max(axis=1).min() for one in at[:: max(1, len(at) // 80)]]
            return np.abs(np.array(gaps) - frames.CELL / 2) / frames.CELL

        items += [field(near, 0.51), field(near, 0.51)]
    items += part(lambda ax: ax.fill([], [])) * 2
    level_ground = frames.reachable()[np.abs(frames.reachable()[:, 1]) < frames.CELL / 2][:, 0]
    turn = np.linspace(0, 2 * np.pi, 200)
    rings = [
        np.c_[SHIFT + r * np.cos(turn), r * np.sin(turn)]
        for r in (level_ground.max(), level_ground.min())
    ]
    top = [shape(np.vstack(rings)), *map(track, rings)]
    for q1 in (-90.0, 0.0):
        at = np.radians([q1, 20.0, 0.0, 60.0])
        top += part(lambda ax, at=at: draw_from_above(ax, at))
    top += [words("$q_1=-90°$", (level_ground.max() - 0.6, 0.4))]
    top += [words("$q_1=0$", (0.8, level_ground.max() - 1.2))]
    return fig, [
        Panel(REACH, HEIGHT, items, "side: section through the arm"),
        Panel("forward $x$ [m]", "left $y$ [m]", top, "top: where the teeth reach level ground"),
    ]


def ellipses():
    """The axes of each ellipse are the pin's fastest and slowest velocities, found by trying."""
    postures = [Q, LOW]
    fig = inverse.velocity_ellipses(postures)
    items = scene((-2.6, 9.0, -3.4, 6.4))
    for q in postures:
        start, elbow, pin, _ = points(q)
        items.append(track([start, elbow, pin]))
        angle = np.linspace(0, np.pi, 200_001)
        speeds = np.cos(angle), np.sin(angle)
        steps = [
            points(q + 1e-6 * np.eye(4)[j])[2] - points(q - 1e-6 * np.eye(4)[j])[2] for j in (1, 2)
        ]
        velocity = np.outer(speeds[0], steps[0]) + np.outer(speeds[1], steps[1])
        size = np.linalg.norm(velocity, axis=1) / 2e-6
        for pick in (size.argmax(), size.argmin()):
            half = velocity[pick] / 2e-6 / 4
            drawn = min(
                (one.get_xydata() for one in fig.axes[0].lines if len(one.get_xdata()) == 2),
                key=lambda ends, pin=pin, half=half: min(
                    np.abs(ends - [pin + sign * half, pin - sign * half]).max() for sign in (1, -1)
                ),
            )
            gap = np.abs(np.sort(drawn, axis=0) - np.sort([pin + half, pin - half], axis=0)).max()
            assert gap < 1e-3
            items.append(track(drawn))
        wide, high = size.max() / 2, size.min() / 2
        shown = min(
            fig.axes[0].patches[-2:], key=lambda e, pin=pin: np.abs(e.get_center() - pin).sum()
        )
        np.testing.assert_allclose((shown.get_width(), shown.get_height()), (wide, high), rtol=1e-4)
        fast = velocity[size.argmax()]
        turn = np.degrees(np.arctan2(fast[1], fast[0])) - shown.get_angle()
        assert abs((turn + 90) % 180 - 90) < 0.1
        items.append(ellipse(pin, shown.get_width(), shown.get_height(), shown.get_angle()))
    return fig, [Panel(REACH, HEIGHT, items)]


def det(boom, stick):
    """|det J| of the pose, from the position's Jacobian by differences, swing included."""
    q = np.zeros((np.size(boom), 4))
    q[:, 1], q[:, 2] = np.radians(boom), np.radians(stick)
    J = np.stack(
        [
            (kinematics.pose(q + 1e-6 * np.eye(4)[j]) - kinematics.pose(q - 1e-6 * np.eye(4)[j]))
            / 2e-6
            for j in range(3)
        ],
        axis=-1,
    )
    return np.abs(np.linalg.det(J[:, :3, :]))


def over_the_axis(boom, stick):
    q = np.zeros((np.size(boom), 4))
    q[:, 1], q[:, 2] = np.radians(boom), np.radians(stick)
    pin = kinematics.pose(q)
    return -(pin[:, 0] - SHIFT) * np.sin(q[:, 0]) + pin[:, 1] * np.cos(q[:, 0])


def singular():
    straight = np.degrees(-BACKHOE.stick.angle_offset)
    (low2, low3), (high2, high3) = (np.degrees(v[1:3]) for v in (BACKHOE.lower, BACKHOE.upper))
    items = [
        field(det, 0.5), field(over_the_axis, 0.01), level(straight), level(straight - 180),
        box(low2, low3, high2, high3), words("within the limits", (low2 + 4, low3 + 5)),
        words("arm stretched", (-172, straight + 5)), words("arm folded", (-172, straight - 175)),
        words("pin over\nthe axis", (122, -40)),
    ]  # fmt: skip
    return inverse.singularities(), [Panel("boom $q_2$ [deg]", "stick $q_3$ [deg]", items)]


def turned():
    poses, centre = np.array([(0.0, 0.0, 0.0), (1.0, 0.3, 0.4), (1.8, 0.8, 0.8)]), (0.0, 3.0)
    left = np.c_[-np.sin(poses[:, 2]), np.cos(poses[:, 2])] * BACKHOE.tracks.gauge / 2
    items = [
        track(poses[:, :2] + left, "left track"), track(poses[:, :2] - left, "right track"),
        track(poses[:, :2], "middle"), track([centre], "centre of rotation"),
    ]  # fmt: skip
    items += [track([centre, pose[:2]]) for pose in poses]
    half = np.array([BACKHOE.tracks.length, BACKHOE.tracks.shoe_width]) / 2
    for (x, y, psi), side in zip(poses, left, strict=True):
        R = np.array([(np.cos(psi), -np.sin(psi)), (np.sin(psi), np.cos(psi))])
        for sign in (1, -1):
            corners = half * [(1, 1), (-1, 1), (-1, -1), (1, -1)]
            items.append(shape(corners @ R.T + (x, y) + sign * side))
        items.append(shape(np.array([(0.2, 0.16), (0.2, -0.16), (1.1, 0)]) @ R.T + (x, y)))
    fig = steps.turn(poses, centre, title="there")
    return fig, [Panel("$x$ [m]", "$y$ [m]", items, "there")]


TestFrames = proofs(frames, {"arm": two_arms, "frames": framed, "workspace": reach})
TestInverse = proofs(
    inverse, {"elbows": two_elbows, "singularities": singular, "velocity_ellipses": ellipses}
)
TestSteps = proofs(steps, {"turn": turned})

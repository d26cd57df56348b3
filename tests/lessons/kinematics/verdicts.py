"""What decides each verdict on the thesis's kinematics: properties, and likely misprints."""

import numpy as np

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE

RNG = np.random.default_rng(11)
Q = RNG.uniform(-np.pi, np.pi, (50, 4))
JACOBIANS = kinematics.task_jacobian(Q)


# (2.2) link transforms


def links_are_the_rows_of_denavit_and_hartenberg_one_after_another(link_transforms):
    base, swing = BACKHOE.base, BACKHOE.swing

    def row(angle, length, height=0.0, twist=0.0):
        c, s, ct, st = np.cos(angle), np.sin(angle), np.cos(twist), np.sin(twist)
        return np.array(
            [[c, -s * ct, s * st, length * c], [s, c * ct, -c * st, length * s],
             [0, st, ct, height], [0, 0, 0, 1]]
        )  # fmt: skip

    for q in Q:
        T = row(0.0, base.offset, base.height)
        T = T @ row(q[0] + np.pi / 2, swing.offset, swing.height, np.pi / 2)
        expected = [T]
        for angle, link in zip(q[1:], BACKHOE.links, strict=True):
            expected.append(expected[-1] @ row(angle + link.angle_offset, link.length))
        assert np.allclose(link_transforms(q), expected, atol=1e-9)


def link_transforms_without_the_twist(q):
    T = kinematics.link_transforms(q).copy()
    T[..., :3, 1:3] = T[..., :3, 2:0:-1]
    return T


# (2.4) to (2.7) the damped inverse


def gain_is_at_most_half_of_one_over_the_damping(inverse, damping=0.1):
    sigma = np.linalg.norm([inverse(J, damping) for J in JACOBIANS], 2, axis=(1, 2))
    assert sigma.max() <= 0.5 / damping + 1e-9


# (A.18) angular Jacobians


def angular_jacobian_turns_the_frame(angular_jacobians, step=1e-6):
    for q in Q[:10]:
        for joint, e in enumerate(np.eye(4) * step):
            after, before = (kinematics.link_transforms(q + one)[:, :3, :3] for one in (e, -e))
            spin = (after - before) / (2 * step) @ np.swapaxes(after + before, 1, 2) / 2
            omega = np.stack((spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]), axis=-1)
            assert np.allclose(angular_jacobians(q)[:, :, joint], omega, atol=1e-4)


def angular_jacobians(q):
    frames = ("swing", "boom", "stick", "tip")
    return np.stack([kinematics.jacobian(q, frame)[..., 3:, :] for frame in frames], axis=-3)

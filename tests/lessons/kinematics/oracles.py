"""What proves the answers of lesson 01's exercises."""

import numpy as np
from scipy.optimize import minimize

from backhoe.arm import kinematics
from backhoe.machine import BACKHOE

STEP = 1e-5


def seen_by_the_forward_kinematics(answer, direction, pitches):
    """The frames at these joint angles look in the direction and have the pitches asked for."""
    R = kinematics.link_transforms(answer)[:, :3, :3]
    seen = np.array([np.cos(direction), np.sin(direction), 0.0])
    np.testing.assert_allclose(R[0, :, 0], seen, atol=1e-12)
    np.testing.assert_allclose(R[1:, :, 0] @ seen, np.cos(pitches), atol=1e-12)
    np.testing.assert_allclose(R[1:, 2, 0], np.sin(pitches), atol=1e-12)


def tip_in_the_plane_of_the_arm(answer, q):
    """The tip's frame, turned back by the swing, has that place and pitch, whole turns counted."""
    T = kinematics.forward_kinematics(q)
    outwards, up = np.array([-np.sin(q[0]), np.cos(q[0]), 0.0]), np.array([0.0, 0.0, 1.0])
    rho, z, pitch = answer
    place = T[:3, 3] - (BACKHOE.base.offset, 0.0, 0.0)
    np.testing.assert_allclose((rho, z), (outwards @ place, up @ place), atol=1e-12)
    seen = outwards @ T[:3, 0], up @ T[:3, 0]
    np.testing.assert_allclose((np.cos(pitch), np.sin(pitch)), seen, atol=1e-12)
    assert abs(pitch - q[1:].sum() - sum(link.angle_offset for link in BACKHOE.links)) < 0.1


def lowest_of_all_within_the_limits(answer, machine):
    """SciPy finds the lowest teeth within the box of the limits, from many starts."""

    def height(q):
        pitch = np.cumsum(q + [link.angle_offset for link in machine.links])
        rise = np.sin(pitch) @ [link.length for link in machine.links]
        return machine.base.height + machine.swing.height + rise

    box = list(zip(machine.lower[1:], machine.upper[1:], strict=True))
    starts = np.stack(np.meshgrid(*box), -1).reshape(-1, 3)
    deepest = -min(minimize(height, 0.9 * start, bounds=box).fun for start in starts)
    assert -1e-6 <= deepest - answer < 0.012


def spin_of_the_turning_link(answer, q, link):
    """dR/dq_i R^T of the link's frame, by differences, is the cross product with column i."""
    turned = STEP * np.eye(4)
    ahead, behind, here = (
        kinematics.link_transforms(at)[..., link - 1, :3, :3] for at in (q + turned, q - turned, q)
    )
    spins = (ahead - behind) / (2 * STEP) @ here.T
    np.testing.assert_allclose(spins, np.cross(np.eye(3), answer.T[:, None]), atol=1e-9)


def teeth_a_moment_later(answer, q, speed):
    """Moved so for a moment, the teeth have gone outwards only, swing and bucket's axes at rest."""
    ahead, behind = (kinematics.forward_kinematics(q + dt * answer) for dt in (STEP, -STEP))
    rate = (ahead - behind) / (2 * STEP)
    outwards = speed * np.array([-np.sin(q[0]), np.cos(q[0]), 0.0])
    np.testing.assert_allclose(rate[:3, 3], outwards, atol=1e-7)
    np.testing.assert_allclose(rate[:3, :3], np.zeros((3, 3)), atol=1e-8)


def back_at_the_target_elbow_up(answer, target):
    """The forward kinematics leads back to the target, within limits that bar the elbow down."""
    np.testing.assert_allclose(kinematics.pose(answer), target, atol=1e-9)
    assert (BACKHOE.lower - 1e-9 <= answer).all() and (answer <= BACKHOE.upper + 1e-9).all()


def gradient_of_damped_least_squares_is_zero(answer, J, damping):
    """At dq = answer e the gradient of |J dq - e|^2 + damping^2 |dq|^2 is zero, for every e."""
    gradient = J.T @ (J @ answer - np.eye(len(J))) + damping**2 * answer
    np.testing.assert_allclose(gradient, np.zeros(J.T.shape), atol=1e-10)


def there_within_the_limits_or_out_of_reach(answer, target):
    """The teeth's pin is there; where it gives up, the triangle of boom, stick and d is none."""
    if isinstance(answer, ValueError):
        place = target[:3] - (BACKHOE.base.offset, 0, BACKHOE.base.height + BACKHOE.swing.height)
        d = np.hypot(np.hypot(*place[:2]) - BACKHOE.swing.offset, place[2])
        boom, stick = BACKHOE.boom.length, BACKHOE.stick.length
        assert not boom - stick < d < boom + stick
    else:
        np.testing.assert_allclose(kinematics.pose(answer), target, atol=2e-6)
        assert (BACKHOE.lower <= answer).all() and (answer <= BACKHOE.upper).all()


def belts_that_do_not_slip(answer, heading):
    """With one sprocket turning, each belt's middle moves with its own belt, and not sideways."""
    ahead = np.array([np.cos(heading), np.sin(heading)])
    belts = BACKHOE.tracks.sprocket_radius * np.eye(2)
    for (dx, dy, dpsi), (right, left) in zip(answer.T, belts, strict=True):
        for side, belt in ((-1, right), (1, left)):
            rate = np.array([dx, dy]) - dpsi * side * BACKHOE.tracks.gauge / 2 * ahead
            np.testing.assert_allclose(rate, belt * ahead, atol=1e-12)


EQUAL = {
    "1.4": {"link is never negative": "the number of a link"},
    "1.7": {
        "J[3] is never negative": "the row of the pitch: each joint turns it by 0 or 1",
        "the result at [3] is never negative": "its share in the inverse of such a Jacobian",
    },
}
"""Mutants that are the reference in disguise, with the reason."""

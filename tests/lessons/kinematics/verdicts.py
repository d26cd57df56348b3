"""What decides each verdict on the thesis's kinematics: properties, and likely misprints."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import lstsq
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from backhoe.arm import kinematics
from backhoe.lessons import published
from backhoe.machine import BACKHOE
from backhoe.vehicle import tracks

RNG = np.random.default_rng(11)
Q = RNG.uniform(-np.pi, np.pi, (50, 4))
POSTURES = RNG.uniform(BACKHOE.lower, BACKHOE.upper, (20, 4))
SPEEDS, HEADINGS = RNG.normal(size=(20, 2)), RNG.uniform(-np.pi, np.pi, 20)
JACOBIANS = kinematics.task_jacobian(Q)
DAMPING, STEP = 0.1, 1e-6


def _frames(q):
    """T_01 to T_04 as products of Denavit-Hartenberg matrices, shape (4, 4, 4)."""

    def row(angle, length, height=0.0, twist=0.0):
        c, s, ct, st = np.cos(angle), np.sin(angle), np.cos(twist), np.sin(twist)
        return np.array(
            [[c, -s * ct, s * st, length * c], [s, c * ct, -c * st, length * s],
             [0, st, ct, height], [0, 0, 0, 1]]
        )  # fmt: skip

    base, swing = BACKHOE.base, BACKHOE.swing
    T = row(0.0, base.offset, base.height)
    frames = [T @ row(q[0] + np.pi / 2, swing.offset, swing.height, np.pi / 2)]
    for angle, link in zip(q[1:], BACKHOE.links, strict=True):
        frames.append(frames[-1] @ row(angle + link.angle_offset, link.length))
    return np.array(frames)


def _rates(q):
    """dT/dq of the four frames by differences, shape (joint, frame, 4, 4)."""
    turns = STEP * np.eye(4)
    return np.array([_frames(q + turn) - _frames(q - turn) for turn in turns]) / (2 * STEP)


# (2.1) to (2.3) frames


def the_numbers_tell_the_whole_pose(coordinates):
    for q in Q:
        x = coordinates(q)
        T = _frames(q)[3]
        assert np.allclose(x[:3], T[:3, 3], atol=1e-9)
        assert np.allclose(Rotation.from_euler("zyx", x[3:]).as_matrix(), T[:3, :3], atol=1e-9)


def coordinates_of_the_tip(q):
    T = kinematics.forward_kinematics(q)
    return np.append(T[:3, 3], Rotation.from_matrix(T[:3, :3]).as_euler("zyx"))


def coordinates_without_roll(q):
    return coordinates_of_the_tip(q) * (1, 1, 1, 1, 1, 0)


def links_are_the_rows_of_denavit_and_hartenberg_one_after_another(link_transforms):
    for q in Q:
        assert np.allclose(link_transforms(q), _frames(q), atol=1e-9)


def link_transforms_without_the_twist(q):
    T = kinematics.link_transforms(q).copy()
    T[..., :3, 1:3] = T[..., :3, 2:0:-1]
    return T


def the_last_column_is_the_tip_seen_from_the_base(transform):
    for q in Q:
        pitches = np.cumsum(q[1:] + [link.angle_offset for link in BACKHOE.links])
        rho, z = BACKHOE.swing.offset, BACKHOE.base.height + BACKHOE.swing.height
        for pitch, link in zip(pitches, BACKHOE.links, strict=True):
            rho, z = rho + link.length * np.cos(pitch), z + link.length * np.sin(pitch)
        tip = BACKHOE.base.offset - rho * np.sin(q[0]), rho * np.cos(q[0]), z
        assert np.allclose(transform(q)[:3, 3], tip, atol=1e-9)


def there_is_more_than_one_answer_and_each_leads_back(answers):
    for q in POSTURES:
        target = _frames(q)[2, :3, 3]
        found = answers([*target, q[3]])
        assert len(found) > 1 and np.abs(np.sin((found[0] - found[1]) / 2)).max() > 1e-3
        assert np.allclose([_frames(one)[2, :3, 3] for one in found], target, atol=1e-7)


def both_elbows(target):
    elbows = ("up", "down")
    return [kinematics.inverse_kinematics(target, one, limits=False) for one in elbows]


def one_elbow(target):
    return both_elbows(target)[:1]


def newton_finds_a_place_whatever_the_direction_asked(residual):
    goal = _frames(np.radians([-80.0, 15.0, -10.0, 40.0]))[2]
    goal[:3, :3] = goal[:3, :3] @ Rotation.from_euler("x", 0.5).as_matrix()
    q = np.radians([-75.0, 12.0, -5.0, 40.0])
    for _ in range(20):
        nudged = (residual(q + turn, goal) for turn in STEP * np.eye(4))
        slope = np.array([(one - residual(q, goal)) / STEP for one in nudged]).T
        q = q - lstsq(slope, residual(q, goal))[0]
    assert np.allclose(_frames(q)[2, :3, 3], goal[:3, 3], atol=1e-6)


def residual_of_the_place(q, goal):
    return (goal - kinematics.forward_kinematics(q, "stick"))[:3, 3]


def residual_of_the_whole_matrix(q, goal):
    return (goal - kinematics.forward_kinematics(q, "stick"))[:3].ravel()


# (2.4) to (2.7) the damped inverse


def gain_is_at_most_half_of_one_over_the_damping(inverse):
    sigma = np.linalg.norm([inverse(J, DAMPING) for J in JACOBIANS], 2, axis=(1, 2))
    assert sigma.max() <= 0.5 / DAMPING + 1e-9


def the_step_is_that_of_least_squares_with_the_damping_below(inverse):
    for J in JACOBIANS:
        below = np.vstack((J, DAMPING * np.eye(4)))
        assert np.allclose(inverse(J, DAMPING), lstsq(below, np.eye(8, 4))[0], atol=1e-9)


def each_gain_makes_its_error_and_its_step_small(gains):
    sigma = np.append(0.0, np.geomspace(0.01, 9.0, 30))
    for gain, s in zip(gains(sigma, DAMPING), sigma, strict=True):
        least = minimize_scalar(lambda x, s=s: (s * x - 1) ** 2 + (DAMPING * x) ** 2)
        assert np.isclose(gain, least.x, rtol=1e-5, atol=1e-6)


def gains_of_the_damped_inverse(sigma, damping):
    return np.diag(kinematics.damped_inverse(np.diag(sigma), damping))


def gains_26(sigma, damping):
    return sigma / (sigma**2 + damping**2)


def gains_26_with_the_damping_unsquared(sigma, damping):
    return sigma / (sigma**2 + damping)


# (2.8) to (2.10) the tracks


def held_speeds_lead_round_a_circle_and_back(rates, v=0.6, omega=0.3):
    def rate(_, pose):
        return rates([v, omega], pose[2])

    way = solve_ivp(rate, (0, 2 * np.pi / omega), np.zeros(3), rtol=1e-10, atol=1e-10).y
    assert np.allclose(way[:, -1], [0, 0, 2 * np.pi], atol=1e-6)
    assert np.allclose(np.hypot(way[0], way[1] - v / omega), v / omega, atol=1e-6)


def each_belt_moves_at_the_speed_of_its_sprocket(twist):
    r, half = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge / 2
    for left, right in SPEEDS:
        v, omega = twist(left, right)
        belts = [v + np.cross([0, 0, omega], [0, y, 0])[0] for y in (half, -half)]
        assert np.allclose(belts, [r * left, r * right], atol=1e-12)


def twist_29(left, right, l=BACKHOE.tracks.gauge):  # noqa: E741
    v_l, v_r = BACKHOE.tracks.sprocket_radius * left, BACKHOE.tracks.sprocket_radius * right
    return (v_r + v_l) / 2, (v_r - v_l) / l


def twist_29_with_half_the_gauge(left, right):
    return twist_29(left, right, BACKHOE.tracks.gauge / 2)


def one_sprocket_alone_turns_the_machine_about_the_other_belt(matrix):
    r, half = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge / 2
    for psi in HEADINGS:
        ahead = np.array([np.cos(psi), np.sin(psi)])
        for (*middle, turn), belts in zip(matrix(psi).T, r * np.eye(2), strict=True):
            over_ground = [middle - turn * side * half * ahead for side in (-1, 1)]
            assert np.allclose(over_ground, np.outer(belts, ahead), atol=1e-12)


def track_matrix(heading):
    return np.column_stack([tracks.world_rates(*sides, heading) for sides in ((0, 1), (1, 0))])


# (A.16) to (A.18) Jacobians


def joint_speeds_times_it_are_the_speeds_of_the_tip(jacobian):
    for q in Q[:20]:
        rates = _rates(q)[:, 3]
        spins = rates[:, :3, :3] @ _frames(q)[3, :3, :3].T
        omega = np.stack((spins[:, 2, 1], spins[:, 0, 2], spins[:, 1, 0]))
        assert np.allclose(jacobian(q), np.vstack((rates[:, :3, 3].T, omega)), atol=1e-6)


def jacobian_a16(q):
    J = kinematics.jacobian(q)
    J_L, J_w = J[:3], J[3:]
    return np.vstack((J_L, J_w))


def jacobian_with_the_spin_first(q):
    return np.roll(kinematics.jacobian(q), 3, axis=0)


def each_is_the_jacobian_of_a_point_fixed_to_its_link(linear_jacobians):
    """Of all points: such a Jacobian is linear in the point, so least squares finds the best."""
    J = np.array([linear_jacobians(q) for q in Q])
    rates = np.array([_rates(q) for q in Q])
    for link in range(4):
        A = rates[:, :, link, :3, :3].reshape(-1, 3)
        rest = np.swapaxes(J[:, link], 1, 2) - rates[:, :, link, :3, 3]
        point = lstsq(A, rest.ravel())[0]
        assert np.allclose(A @ point, rest.ravel(), atol=1e-6)


def linear_jacobians(q):
    masses = ("swing_com", "boom_com", "stick_com", "bucket_com")
    return np.stack([kinematics.jacobian(q, one)[..., :3, :] for one in masses], axis=-3)


def angular_jacobian_turns_the_frame(angular_jacobians):
    for q in Q[:10]:
        spins = _rates(q)[..., :3, :3] @ np.swapaxes(_frames(q)[:, :3, :3], 1, 2)
        omega = np.stack((spins[..., 2, 1], spins[..., 0, 2], spins[..., 1, 0]), axis=-1)
        assert np.allclose(angular_jacobians(q), np.moveaxis(omega, 0, -1), atol=1e-6)


def angular_jacobians(q):
    frames = ("swing", "boom", "stick", "tip")
    return np.stack([kinematics.jacobian(q, frame)[..., 3:, :] for frame in frames], axis=-3)


# Tables A.1 and A.2


def the_mass_of_a_link_lies_along_it(offsets):
    links, masses = offsets()
    assert np.degrees(np.abs(masses - links)).max() < 30


def angle_offsets():
    links = BACKHOE.links
    return [
        np.array([getattr(link, name) for link in links]) for name in ("angle_offset", "com_angle")
    ]


def the_arm_weighs_on_its_joints_as_section_231_prints(arm):
    """Weights times lever arms at q3 = -10 deg, the stick hanging: tau_0 to 0.1 kN m."""
    length, radius, *angles, mass = arm
    link, com = np.radians(angles) * (1, -1, -1)
    pitch = np.cumsum(link + np.radians([0, -10, 0]))
    joint = np.append(0.0, np.cumsum(length * np.cos(pitch)))[:3]
    place = joint + radius * np.cos(pitch + com - link)
    torque = [9.81 * mass[i:] @ (place[i:] - joint[i]) for i in range(3)]
    expected = published.load("mastalli_2013_free_fall")["gravity_torque"][1:]
    assert np.allclose(torque, expected, rtol=0, atol=100)


_TABLE = published.load("mastalli_2013_table_a2")
_PRINTED = {"lengths": ("L_{}", "L_cm{}"), "angles_deg": ("theta_{}", "theta_cm{}")}
TABLE_A2 = np.array(
    [
        [_TABLE[group][name.format(i)] for i in (2, 3, 4)]
        for group, names in _PRINTED.items()
        for name in names
    ]
    + [[_TABLE["masses"][name] for name in ("m_bo", "m_s", "m_bu")]]
)
ARM = np.abs(
    [
        [getattr(link, name) * unit for link in BACKHOE.links]
        for name, unit in (
            ("length", 1), ("com_radius", 1), ("angle_offset", np.degrees(1)),
            ("com_angle", np.degrees(1)), ("mass", 1),
        )
    ]
)  # fmt: skip
TABLE_WITH_STICK_AND_BUCKET_SWAPPED = TABLE_A2[:, [0, 2, 1]]

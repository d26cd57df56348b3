"""What proves the references of lesson 02: the places of the arm's bodies, differentiated.

`mass_matrix`, `gravity_torque` and their like are closed forms. The oracles use none of them: they
take the poses of the centres of mass from forward kinematics, differentiate them numerically, and
do what Lagrange does.
"""

from itertools import product

import numpy as np
from numpy.testing import assert_allclose

from backhoe.arm import dynamics, kinematics
from backhoe.lessons import published
from backhoe.machine import BACKHOE
from backhoe.machine.variants import reading

EQUAL = {"2.8": {"dt is never negative": "a simulation goes forward in time"}}
"""Mutants of a reference that its check may take for right, and why."""

BODIES = dict(
    zip(
        ("swing_com", "boom_com", "stick_com", "bucket_com"),
        (BACKHOE.swing, *BACKHOE.links),
        strict=True,
    )
)


def slopes(function, x, step=1e-5):
    """Central differences: axis 0 is the component of x that moves."""
    return np.array([(function(x + d) - function(x - d)) / (2 * step) for d in step * np.eye(4)])


def position(frame):
    return lambda q: kinematics.forward_kinematics(q, frame)[:3, 3]


def lagrange_with_one_angle(answer, angle):
    """ddq = -(dU/dq) / (d^2 K/d dq^2), with the boom's centre of mass as a complex number."""
    boom, step = BACKHOE.boom, 1e-5
    centre = boom.com_radius * np.exp(1j * (angle + boom.com_angle + step * np.array([-1, 1])))
    velocity = (centre[1] - centre[0]) / (2 * step)
    inertia = boom.mass * abs(velocity) ** 2 + boom.inertia
    assert_allclose(answer * inertia, -boom.mass * BACKHOE.gravity * velocity.imag, rtol=1e-8)


def slope_of_the_heights(answer, q):
    """g is the slope of the potential energy: weights times the heights of the centres of mass."""

    def potential(q):
        heights = [body.mass * position(frame)(q)[2] for frame, body in BODIES.items()]
        return BACKHOE.gravity * sum(heights)

    assert_allclose(answer, slopes(potential, q), rtol=1e-6, atol=1e-3)


def kinetic_energy(answer, q, load):
    """M is the sum of m v v + I w w, with v and w from poses a little before and behind."""
    M = np.zeros((4, 4))
    for frame, body in BODIES.items():
        R = kinematics.forward_kinematics(q, frame)[:3, :3]
        turning = slopes(lambda q, frame=frame: kinematics.forward_kinematics(q, frame)[:3, :3], q)
        spin = (turning @ R.T)[:, [2, 0, 1], [1, 2, 0]]
        v = slopes(position(frame), q)
        M += (body.mass + load * (frame == "bucket_com")) * v @ v.T + body.inertia * spin @ spin.T
    assert_allclose(answer, M, rtol=1e-6, atol=1e-3)


def lagrange_without_gravity(answer, q, dq):
    """C dq is d/dt dK/d dq - dK/dq at constant speeds, by finite differences of K and of M."""
    step = 1e-5
    change = dynamics.mass_matrix(q + step * dq) - dynamics.mass_matrix(q - step * dq)
    rise = slopes(lambda q: dynamics.energy(q, dq)[0], q)
    assert_allclose(answer, change @ dq / (2 * step) - rise, rtol=1e-6, atol=1e-2)


def virtual_work(answer, q, tip_force):
    """In a small turn of a joint the torque pays for what is lifted and for what is pushed."""
    lifted = slopes(lambda q: dynamics.energy(q, np.zeros(4))[1], q)
    pushed = slopes(position("tip"), q) @ tip_force
    assert_allclose(answer, lifted + pushed, rtol=1e-6, atol=1e-2)


def inertia_about_the_stick_joint(answer, q):
    """The sum of I and m r^2, with r from the boom's end to the centres of mass in space."""
    joint = position("boom")(q)
    bodies = [(BACKHOE.stick, "stick_com"), (BACKHOE.bucket, "bucket_com")]
    radii = [np.linalg.norm(position(frame)(q) - joint) for _, frame in bodies]
    parts = [body.inertia + body.mass * r**2 for (body, _), r in zip(bodies, radii, strict=True)]
    assert_allclose(answer, sum(parts), rtol=1e-9)


def three_clues(answer):
    """Of the 256 arms that Table A.1 allows, those along the steel, and of them the nearest."""
    witness = published.load("mastalli_2013_free_fall")
    angles = published.load("mastalli_2013_table_a2")["angles_deg"]
    sizes = [angles[name] for name in ("theta_3", "theta_cm3", "theta_4", "theta_cm4")]
    arms = np.array(list(product(*([s, -s, s - 90, -s - 90] for s in sizes))))
    bends = np.abs((arms[:, [0, 2]] - arms[:, [1, 3]] + 180) % 360 - 180).max(axis=1)
    arms = arms[bends < 60]
    q = np.radians(witness["start_deg"])
    g = np.array([dynamics.gravity_torque(q, machine=reading(arm)) for arm in arms])
    best = np.abs(g - witness["gravity_torque"]).max(axis=1).argmin()
    assert_allclose(answer, arms[best], atol=0.01)


def speed_first_by_inverse_dynamics(answer, q, dq, tau, dt):
    """Torques of the change of speed are those given, and the angle moves with the new speed."""
    q_new, dq_new = answer
    assert_allclose(dynamics.inverse_dynamics(q, dq, (dq_new - dq) / dt), tau, rtol=1e-6, atol=0.1)
    assert_allclose((q_new - q) / dt, dq_new, rtol=1e-8, atol=1e-10)


def moments_about_the_edges(answer, q):
    """Moments of all weights about the four edges: with the load one is zero, none is negative."""
    tracks = BACKHOE.tracks
    load = (answer, position("bucket_com")(q))
    weights = [(tracks.mass, np.zeros(3)), load]
    weights += [(body.mass, position(frame)(q)) for frame, body in BODIES.items()]
    half = np.array([tracks.length / 2, tracks.gauge / 2 + tracks.shoe_width / 2])
    moments = [
        sum(mass * (half[axis] - side * at[axis]) for mass, at in weights)
        for axis in range(2)
        for side in (1, -1)
    ]
    assert_allclose(min(moments), 0.0, atol=1e-9 * BACKHOE.mass)
    assert answer > 0

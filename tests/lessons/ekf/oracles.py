"""What proves the references of lesson 07: each oracle says its way in its docstring."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from backhoe.machine import BACKHOE


def slopes(function, x):
    """Derivative of a real function by a complex step: exact to rounding, with no formula."""
    steps = x + 1e-30j * np.eye(len(x))
    return np.stack([function(step).imag / 1e-30 for step in steps], axis=-1)


def rolled(pose, way, turn):
    """The pose after a way along the middle heading, and a turn: (4.24) repaired."""
    middle = pose[2] + turn / 2
    return pose + np.array([way * np.cos(middle), way * np.sin(middle), turn])


def driven(pose, sides):
    """The pose after both sprockets turned: each belt's way is its sprocket's turn times r."""
    left, right = BACKHOE.tracks.sprocket_radius * sides
    return rolled(pose, (left + right) / 2, (right - left) / BACKHOE.tracks.gauge)


def conditioned(x, P, surprise, H, R):
    """x and its covariance given z, from blocks of the inverse of the covariance of x and z."""
    n = len(x)
    precision = np.linalg.inv(np.block([[P, P @ H.T], [H @ P, H @ P @ H.T + R]]))
    covariance = np.linalg.inv(precision[:n, :n])
    return x - covariance @ precision[:n, n:] @ surprise, covariance


def nearest_turn(angle):
    """The angle as it is nearest to zero, of all that are whole turns apart."""
    return min(angle + 2 * np.pi * np.arange(-9, 10), key=abs)


def every_way_to_each_place(answer, belief, transition, likelihood):
    """Every pair of places is gone through one by one, and the ways to each place counted."""
    ways = {
        (to, start): belief[start] * transition[to, start] * likelihood[to]
        for to, start in np.ndindex(transition.shape)
    }
    share = [sum(ways[to, start] for start in range(len(belief))) for to in range(len(belief))]
    assert_allclose(answer, np.divide(share, sum(ways.values())), rtol=1e-12)


def the_joint_normal_conditioned(answer, x, P, z, H, R):
    """State and measurement have a joint normal distribution; its precision gives x given z."""
    for found, wanted in zip(answer, conditioned(x, P, z - H @ x, H, R), strict=True):
        assert_allclose(found, wanted, rtol=1e-8, atol=1e-10)


def the_derivative_of_the_step(answer, psi, b, v, omega, T_s):
    """The step itself, with its bias in the turn, differentiated by a complex step."""

    def step(state):
        turn = (omega - state[3]) * T_s
        return np.append(rolled(state[:3], v * T_s, turn), state[3])

    wanted = slopes(step, np.array([0.0, 0.0, psi, b]))
    assert_allclose(answer, wanted, rtol=1e-12, atol=1e-15)


def gravity_turned_into_the_machine(answer, force):
    """SciPy turns the world's vertical into a machine of that roll and pitch: it is the force."""
    roll, pitch = answer
    up = Rotation.from_euler("ZYX", [0.0, pitch, roll]).inv().apply([0.0, 0.0, 1.0])
    assert_allclose(up, force / np.linalg.norm(force), atol=1e-12)
    assert abs(roll) <= np.pi and abs(pitch) <= np.pi / 2


def the_determinant_with_the_error_in_it(answer, error, P):
    """The matrix determinant lemma: det(P + e e^T) = det(P) (1 + e^T P^-1 e)."""
    e = np.array([*error[:2], nearest_turn(error[2])])
    assert_allclose(answer, np.linalg.det(P + np.outer(e, e)) / np.linalg.det(P) - 1, rtol=1e-7)


def the_noise_through_the_derivative_by_the_sides(answer, psi, left, right, variance):
    """The pose differentiated by each sprocket's turn with a complex step; noises add up."""
    G = slopes(lambda sides: driven(np.array([0.0, 0.0, psi]), sides), np.array([left, right]))
    wanted = sum(variance * np.outer(column, column) for column in G.T)
    assert_allclose(answer, wanted, rtol=1e-10, atol=1e-18)


def the_joint_normal_of_the_moved_pose_and_its_yaw(answer, x, P, left, right, yaw, M, R):
    """Complex-step derivatives by pose and sides, then the joint normal, given the nearest yaw."""
    sides, H = np.array([left, right]), np.array([[0.0, 0.0, 1.0]])
    F = slopes(lambda pose: driven(pose, sides), x)
    G = slopes(lambda turned: driven(x, turned), sides)
    moved = driven(x, sides)
    surprise = np.array([nearest_turn(yaw - moved[2])])
    wanted = conditioned(moved, F @ P @ F.T + M * G @ G.T, surprise, H, np.array([[R]]))
    for found, right_one in zip(answer, wanted, strict=True):
        assert_allclose(found, right_one, rtol=1e-8, atol=1e-10)


def the_nearest_samples_one_by_one(answer, time, signal, time_e, estimate):
    """Plain loops: the sample nearest to each tenth of a second, the angle between directions."""
    squares = []
    for tenth in range(int(10 * min(time[-1], time_e[-1]) + 1e-6) + 1):
        true = signal[min(range(len(time)), key=lambda k: abs(time[k] - tenth / 10))]
        seen = estimate[min(range(len(time_e)), key=lambda k: abs(time_e[k] - tenth / 10))]
        apart = np.angle(np.exp(1j * (seen[2] - true[2])))
        squares.append([(seen[0] - true[0]) ** 2, (seen[1] - true[1]) ** 2, apart**2])
    assert_allclose(np.square(answer), np.mean(squares, axis=0), rtol=1e-10)
    assert np.min(answer) >= 0


def the_joint_determinant_with_the_innovation_in_it(answer, x, P, z, H, R):
    """det(S + y y^T) = det(S) (1 + y^T S^-1 y); det(S) from the joint covariance of x and noise."""
    n, y = len(x), np.array([one - sum(row * x) for one, row in zip(z, H, strict=True)])
    both = np.block([[P, np.zeros((n, len(z)))], [np.zeros((len(z), n)), R]])
    seen = np.hstack([H, np.eye(len(z))])
    S = np.einsum("ij,jk,lk->il", seen, both, seen)
    ratio = np.linalg.det(S + np.outer(y, y)) / np.linalg.det(S) - 1
    assert_allclose(answer, ratio, rtol=1e-7, atol=1e-12)


EQUAL = {
    "7.1": {
        name: "probabilities are never negative, and so are their products and sums"
        for name in (
            "the result is never negative",
            "belief is never negative",
            "transition is never negative",
            "likelihood is never negative",
        )
    },
    "7.3": {"T_s is never negative": "a step takes time"},
    "7.6": {"variance is never negative": "a variance is a mean of squares"},
    "7.7": {
        "M is never negative": "a variance is a mean of squares",
        "R is never negative": "a variance is a mean of squares",
    },
    "7.8": {
        f"{name}: counted from its first sample": "both clocks start at 0"
        for name in ("time", "time_e")
    },
}
"""Mutants of references that are right all the same, and why."""

"""What else lesson 06 takes for right."""

import numpy as np

from backhoe.lessons.odometry.exercises import square, steps
from backhoe.localisation import odometry

rng = np.random.default_rng(6)


def unicycle(x, u):
    return np.array([u[0] * np.cos(x[2]), u[0] * np.sin(x[2]), u[1]])


def test_a_trapezoid_with_x_k_solved_for_counts_as_right_too():
    x, old, new = rng.normal(size=3), np.array([0.5, 0.4]), np.array([0.7, -0.3])
    step = steps.heun(x, old, new, 0.2, unicycle)
    solved = step
    for _ in range(60):
        solved = x + 0.1 * (unicycle(x, old) + unicycle(solved, new))
    assert not np.allclose(step, solved, rtol=1e-9)
    assert steps.right_trapezoid(solved, step, x, old, new, 0.2, unicycle)
    assert not steps.right_trapezoid(step + 1e-4, step, x, old, new, 0.2, unicycle)


def test_what_the_library_makes_of_x_and_y_counts_as_right_too():
    true, nominal = odometry.Wheels(0.349, 0.351, 2.06), odometry.Wheels(0.35, 0.35, 2.0)
    ends = [odometry.square(true, nominal, 4.0, way)[:, :2] for way in ("cw", "ccw")]
    found = odometry.umbmark(*ends, 4.0, nominal)
    averaged = np.array([found.wheels.gauge, found.ratio])
    reference = square.calibrate(*ends, 4.0, 2.0)
    assert not np.allclose(averaged, reference, rtol=1e-6)
    assert square.right_calibration(averaged, reference, *ends, 4.0, 2.0)
    assert not square.right_calibration(1.001 * averaged, reference, *ends, 4.0, 2.0)

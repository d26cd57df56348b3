"""What proves the references of lesson 04: points that move, forces that add up, motors that run.

Places in the plane are complex numbers, x forward and y to the left.
"""

import numpy as np
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline
from scipy.optimize import linprog

from backhoe.vehicle import motor
from backhoe.vehicle.motor import ROVER
from backhoe.vehicle.skid_steer import HUSKY


def velocity(place, step=1e-4):
    """Central difference of a place that is a function of time."""
    return (place(step) - place(-step)) / (2 * step)


def rims_that_meet_the_ground(answer, twist):
    """The rims run as fast as two points c aside of the middle of a body that drives and turns."""
    v, omega = twist
    sides = HUSKY.half_track * np.array([1j, -1j])
    ground = velocity(lambda t: v * t + sides * np.exp(1j * omega * t)).real
    assert_allclose(answer, ground / HUSKY.wheel_radius, atol=1e-6)


def wheels_carried_round_the_centre(answer, omega, x_icr, vehicle):
    """Both axles are turned about a centre at x_ICR, however far aside it lies."""
    axles = np.array([vehicle.front, -vehicle.rear]) + vehicle.half_track * 1j
    for aside in (-2j, 0.7j):
        centre = x_icr + aside
        slip = velocity(lambda t, c=centre: c + (axles - c) * np.exp(1j * omega * t)).imag
        assert_allclose(answer, slip, atol=1e-7)


def an_ideal_vehicle_of_that_half_track(answer, t, left, right, turn):
    """On that half track the ways of the rims, straight splines integrated, make the turn."""
    ways = [
        HUSKY.wheel_radius * make_interp_spline(t, side, k=1).integrate(t[0], t[-1])
        for side in (left, right)
    ]
    assert_allclose((ways[1] - ways[0]) / (2 * answer), turn, rtol=1e-8)


def four_wheels_pushed_and_dragged(answer, vehicle):
    """Newton's law with the forces of each wheel, for motions that show one rate alone."""
    p, (x, y) = vehicle, vehicle.positions.T
    load = p.mass * p.gravity / 4

    def acceleration(v_ref, omega_ref, v, omega):
        wanted, rim = ((a - b * y) / p.wheel_radius for a, b in ((v_ref, omega_ref), (v, omega)))
        along = p.speed_gain * (wanted - rim) / p.wheel_radius - load * p.rolling * v
        across = -load * p.lateral * omega * x
        return along.sum() / p.mass, (x * across - y * along).sum() / p.inertia

    drive_v, drag_v = acceleration(1, 0, 0, 0)[0], -acceleration(1, 0, 1, 0)[0]
    drive_omega, drag_omega = acceleration(0, 1, 0, 0)[1], -acceleration(0, 1, 0, 1)[1]
    assert_allclose(answer, (drive_v, drag_v, drive_omega, drag_omega), rtol=1e-9)


def turned(speed, voltage, torque, load, h, drag=0.0):
    """Speed of the wheel after h: rotor and wheel, whose teeth push each other, integrated."""
    n, m = ROVER.gear, ROVER

    def rate(_, w):
        current = (voltage - m.back_emf * n * w[0]) / m.resistance
        bodies = [[n * m.inertia, 1.0], [load, -n]]  # times acceleration of the wheel, tooth torque
        pushed = [m.torque_constant * current - m.friction * n * w[0], -torque - drag * w[0]]
        return np.linalg.solve(bodies, pushed)[:1]

    run = solve_ivp(rate, (0.0, h), [speed], method="DOP853", rtol=1e-10, atol=1e-12)
    return run.y[0, -1]


def rotor_and_wheel_integrated(answer, *step):
    """Rotor and wheel as two bodies, with the torque between their teeth as an unknown."""
    assert_allclose(answer, turned(*step), rtol=1e-7, atol=1e-9)


def the_integral_read_back(answer, error, dt, kp, ki, limit):
    """Output less P is the integral: it grows by ki dt e where that fits and stands still else."""
    free, P, step = np.abs(answer) < limit, kp * error, ki * dt * error
    before = np.append(0.0, (answer - P)[free])[np.cumsum(free) - free]
    after = np.where(free, answer - P, before)
    fits = np.abs(P + before + step) <= limit
    assert_allclose(after - before, np.where(fits, step, 0.0), atol=1e-9)
    assert_allclose(answer, np.clip(P + after, -limit, limit), rtol=1e-9)


def one_real_pole_is_left(answer):
    """The loop's error is a power, as of one pole four times as fast as the integrated motor's."""
    kp, ki, kd = answer
    load, dt = motor.vehicle_load(HUSKY), motor.WHEEL_PERIOD
    decay, gain = (turned(*at, 0.0, load.inertia, dt, load.friction) for at in ((1, 0), (0, 1)))
    speed, total, errors = 0.0, 0.0, []
    for _ in range(100):
        errors.append(1 - speed)
        total += dt * errors[-1]
        speed = decay * speed + gain * (kp * errors[-1] + ki * total)
    assert_allclose(errors, decay ** (4.0 * np.arange(100)), rtol=1e-6)
    assert kd == 0


def statics_of_two_forces(answer, force, moment, gauge):
    """Two forces ahead, half a gauge aside of the middle, have that sum and that moment."""
    levers = gauge / 2 * np.array([1, -1])
    assert_allclose(sum(answer), force)
    assert_allclose(np.sum(np.multiply(answer, -levers)), moment)


def two_linear_programmes(answer, u_v, u_omega, limit):
    """By linear programming: the turn as near to its wish as both tracks allow, then the speed."""
    tracks = np.array([[1, -1], [1, 1], [-1, 1], [-1, -1]])  # of u_v, u_omega, for both signs
    rows, most = np.c_[tracks, np.zeros((4, 2))], np.full(4, limit)

    def nearest(which, equal=None):  # unknowns u_v, u_omega and how far each is off its wish
        off = np.zeros((2, 4))
        off[:, which], off[:, 2 + which] = (1, -1), -1
        wish = (u_v, u_omega)[which]
        cost = np.eye(4)[2 + which]
        fixed = {} if equal is None else {"A_eq": [[0, 1, 0, 0]], "b_eq": [equal]}
        found = linprog(cost, np.r_[rows, off], np.r_[most, wish, -wish], bounds=(None, None),
                        **fixed)  # fmt: skip
        return found.x[which]

    turn = nearest(1)
    assert_allclose(answer, [nearest(0, turn), turn], rtol=1e-7, atol=1e-7 * limit)


EQUAL = {
    "4.3": {"the result is never negative": "half of a width"},
    "4.4": {"vehicle.gravity: that of the first case": "all of them stand on the Earth"},
    "4.5": {
        "load is never negative": "an inertia",
        "h is never negative": "a time step",
    },
}
"""Mutants that are the reference in disguise, with the reason."""

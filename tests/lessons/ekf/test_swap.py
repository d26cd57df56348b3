"""The part that lesson 07c swaps in: the score tells a right one from usual mistakes."""

from types import SimpleNamespace

import numpy as np
import pytest

from backhoe.lessons.ekf.exercises.motion import encoder_noise, heading_jacobian
from backhoe.localisation import kalman
from backhoe.localisation.drives import SLIPPING
from backhoe.machine import BACKHOE
from backhoe.mission.estimation import EstimatedPlant
from backhoe.mission.score import _claims

R, L = BACKHOE.tracks.sprocket_radius, BACKHOE.tracks.gauge
SLIDE = 0.1  # [m per sqrt(rad)]


class Sliding:
    """A machine that does as it is told, but for slip and for sliding in its turns."""

    machine, dt = BACKHOE, 0.02

    def __init__(self, seed):
        self.time, self.pose, self.rng = 0.0, np.zeros(3), np.random.default_rng([seed, 9])

    def step(self, v, omega):
        middle, turn = self.pose[2] + omega * self.dt / 2, omega * self.dt
        slide = SLIDE * np.sqrt(abs(turn)) * self.rng.standard_normal(2)
        ahead = v * self.dt * np.array([np.cos(middle), np.sin(middle)])
        self.pose = self.pose + np.array([*(ahead + slide), turn])
        self.belts = v + np.array([-1, 1]) * omega / SLIPPING * L / 2
        self.twist, self.time = np.array([v, omega]), self.time + self.dt


class Mine:
    """The lesson's localiser; a mistake replaces one of its settings."""

    slide, R_fix, bias, gyro = SLIDE, 4e-4 * np.eye(2), 0.01, 0.02
    jacobian, noise, update = map(staticmethod, (heading_jacobian, encoder_noise, kalman.update))

    def __init__(self, **mistake):
        vars(self).update(mistake)

    def reset(self, pose):
        self.x, self.P = np.append(pose, 0.0), np.diag([0.01, 0.01, 0.005, self.bias]) ** 2

    def turn(self, left, right, yaw_rate, dt):
        return (yaw_rate - self.x[3]) * dt

    def __call__(self, left, right, yaw_rate, fix, dt):
        (psi, b), way = self.x[2:], R * (left + right) / 2 * dt
        turn = self.turn(left, right, yaw_rate, dt)
        half = turn * L / (2 * R)
        F, Q = self.jacobian(psi, b, way / dt, yaw_rate, dt), np.diag([0, 0, self.gyro * dt**2, 0])
        Q[:3, :3] += self.noise(psi, way / R - half, way / R + half, 0.02 * dt**2)
        Q[:2, :2] += self.slide**2 * abs(turn) * np.eye(2)
        ahead = way * np.array([np.cos(psi + turn / 2), np.sin(psi + turn / 2)])
        self.x, self.P = self.x + np.array([*ahead, turn, 0]), F @ self.P @ F.T + Q
        if fix is not None:
            self.x, self.P = self.update(self.x, self.P, fix, np.eye(4)[:2], self.R_fix)
        return self.x[:3]


class BySprockets(Mine):
    def turn(self, left, right, yaw_rate, dt):
        return R * (right - left) / L * dt


def never_updated(x, P, *seen):
    return kalman.update(x, P, *seen)[0], P


def printed_numbers(make, seed):
    """Claimed sigma [m], NEES and NIS of a drive with bends to either side."""
    plant = EstimatedPlant(Sliding(seed), {"localisation": make()}, 2.5, seed)
    poses = [plant._plant.pose]
    for omega in np.repeat([0.0, 0.4, 0.0, -0.3, 0.3], 300):
        plant.step(0.8, omega)
        poses.append(plant._plant.pose)
    run = SimpleNamespace(
        pose=np.array(poses),
        estimate=np.array(plant.estimates["localisation"]),
        claims=np.array(plant.claims),
        surprises=np.array(plant.surprises),
    )
    return np.array(list(_claims(run).values()))


@pytest.fixture(scope="module")
def right():
    return np.array([printed_numbers(Mine, seed) for seed in range(6)])


def test_a_right_one_is_nearly_honest_and_rather_modest(right):
    """The encoders' noise is counted into the heading too, which the gyroscope tells."""
    _, nees, nis = right.mean(axis=0)
    assert 1.5 < nees < 3.7 and 1.0 < nis < 2.5


@pytest.mark.parametrize(
    "make",
    {
        "no noise at all": lambda: Mine(slide=0.0, gyro=0.0, noise=lambda *step: np.zeros((3, 3))),
        "no slide": lambda: Mine(slide=0.0),
        "R is a standard deviation": lambda: Mine(R_fix=0.02 * np.eye(2)),
        "a fix at its word": lambda: Mine(R_fix=1e-12 * np.eye(2)),
        "a bias that is known": lambda: Mine(bias=0.0),
        "slip ignored": BySprockets,
        "P never updated": lambda: Mine(update=never_updated),
        "F is an identity": lambda: Mine(jacobian=lambda *step: np.eye(4)),
        "noise by its root": lambda: Mine(
            noise=lambda psi, left, right, variance: encoder_noise(psi, left, right, variance**0.5)
        ),
    }.items(),
    ids=lambda item: item[0],
)
def test_a_usual_mistake_moves_a_printed_number_beyond_its_noise(right, make):
    low, high = right.min(axis=0), right.max(axis=0)
    wrong = np.array([printed_numbers(make[1], seed) for seed in range(2)])
    assert ((wrong < low) | (wrong > high)).all(axis=0).any(), (wrong, low, high)

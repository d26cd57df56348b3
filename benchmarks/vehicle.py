"""500 vehicle simulations of 100 s at 50 Hz against python-control: same answers, ratio of times.

Each run holds five random commands, 20 s each. The library takes all runs in one call. The peers
take a few runs, one after the other and command by command, so that their solvers never meet a
jump, and are scaled up: `control.input_output_response` with the solver that suits the model best;
beside it `scipy.integrate.solve_ivp` alone, and the rover in PyBullet, which has other equations
and drives a part of one run. The right-hand sides are plain Python on floats, which for so few
numbers is faster than NumPy.

Exit code 1 when the limit is missed or an answer differs by more than a tenth of a millimetre or
milliradian.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from math import atan, cos, hypot, pi, sin
from time import perf_counter

import control
import numpy as np
from scipy.integrate import solve_ivp

from backhoe.vehicle import skid_steer, tracking
from backhoe.vehicle.skid_steer import HUSKY, SkidSteerPlant, simulate

RUNS, LEGS, SAMPLES, DT = 500, 5, 1000, 0.02
PEER_RUNS = 3
LIMIT = 0.05
ACCURACY = {"rtol": 1e-6, "atol": 1e-8}
SAME = 1e-4

Rate = Callable[[float, np.ndarray, np.ndarray], list[float]]


def linear_rate(_: float, x: np.ndarray, u: np.ndarray) -> list[float]:
    """X, Y, theta, v, omega under (2.15), repaired, and (2.6)."""
    k = LINEAR
    theta, v, omega = float(x[2]), float(x[3]), float(x[4])
    dv = k.drive_v * (float(u[0]) - v) - k.drag_v * v
    domega = k.drive_omega * (float(u[1]) - omega) - k.drag_omega * omega
    return [v * cos(theta), v * sin(theta), omega, dv, domega]


def slipping_rate(_: float, y: np.ndarray, u: np.ndarray) -> list[float]:
    """The ten states of the slipping model with proportional control of the wheels."""
    p, r = HUSKY, HUSKY.wheel_radius
    theta, v_x, v_y, omega, *wheels = map(float, y[2:])
    v_ref, omega_ref = float(u[0]), float(u[1])
    force_x = force_y = moment = 0.0
    spins = []
    for (px, py, load), w in zip(WHEELS, wheels, strict=True):
        along, across = v_x - omega * py - r * w, v_y + omega * px
        slip = hypot(along, across)
        grip = load * (2 / pi * atan(p.smoothing * slip) / slip if slip else 0.0)
        fx, fy = -grip * p.friction_longitudinal * along, -grip * p.friction_lateral * across
        force_x, force_y, moment = force_x + fx, force_y + fy, moment + px * fy - py * fx
        torque = p.speed_gain * ((v_ref - py * omega_ref) / r - w) - load * p.rolling * r * r * w
        spins.append((torque - r * fx) / p.wheel_inertia)
    c, s = cos(theta), sin(theta)
    dv_x, dv_y = force_x / p.mass + v_y * omega, force_y / p.mass - v_x * omega
    return [v_x * c - v_y * s, v_x * s + v_y * c, omega, dv_x, dv_y, moment / p.inertia, *spins]


LINEAR = skid_steer.rates(HUSKY)
WHEELS = [
    (float(x), float(y), float(load))
    for (x, y), load in zip(HUSKY.positions, HUSKY.loads, strict=True)
]
MODELS = {"linear": (linear_rate, 5, "RK45"), "slipping": (slipping_rate, 10, "LSODA")}
TIMES = DT * np.arange(SAMPLES + 1)


def control_s_way(rate: Rate, states: int, method: str, legs: np.ndarray) -> np.ndarray:
    """Where one run ends by `control.input_output_response`, commands (legs, 2)."""
    system = control.nlsys(
        lambda t, x, u, _: rate(t, x, u), None, inputs=2, states=states, name="vehicle"
    )
    state = np.zeros(states)
    for u in legs:
        held = np.repeat(u[:, None], len(TIMES), axis=1)
        response = control.input_output_response(
            system, TIMES, held, state, solve_ivp_method=method, solve_ivp_kwargs=ACCURACY
        )
        state = response.states[:, -1]
    return state


def scipy_s_way(rate: Rate, states: int, method: str, legs: np.ndarray) -> np.ndarray:
    """Where one run ends by `scipy.integrate.solve_ivp`."""
    state = np.zeros(states)
    for u in legs:
        span = (0.0, TIMES[-1])
        state = solve_ivp(rate, span, state, method, TIMES, args=(u,), **ACCURACY).y[:, -1]
    return state


def pybullet_s_time(steps: int = 100) -> float:
    """Time of one run of the rover in PyBullet, from a few of its steps [s]."""
    from backhoe import simulation

    with simulation.open_rover(HUSKY, backend="pybullet", dt=DT) as rover:
        rover.step(0.5, 0.5)
        seconds, _ = timed(lambda: [rover.step(0.5, 0.5) for _ in range(steps)])
    return seconds / steps * LEGS * SAMPLES


def timed(function: Callable[[], object]) -> tuple[float, object]:
    start = perf_counter()
    found = function()
    return perf_counter() - start, found


def best(function: Callable[[], object], repeats: int = 3) -> tuple[float, object]:
    function()
    return min((timed(function) for _ in range(repeats)), key=lambda pair: pair[0])


def report(what: str, figure: float, unit: str, limit: float) -> bool:
    verdict = "ok" if figure <= limit else "MISSED"
    print(f"{what:58s} {figure:9.3g} {unit:5s} limit {limit:<6g} {verdict}")
    return figure <= limit


def measure(model: str, legs: np.ndarray) -> list[bool]:
    """One model, all runs of the library against some of the peers' runs."""
    v, omega = np.repeat(legs, SAMPLES, axis=1).transpose(2, 0, 1)
    ours, runs = best(lambda: simulate(v, omega, DT, model=model, every=SAMPLES))
    few, _ = best(lambda: simulate(v[:50], omega[:50], DT, model=model, every=SAMPLES))
    print(f"{model}: {RUNS} runs of {LEGS * SAMPLES * DT:.0f} s in {ours:.2f} s")
    lines = []
    for name, way in (("control", control_s_way), ("solve_ivp", scipy_s_way)):
        pairs = [timed(lambda k=k, way=way: way(*MODELS[model], legs[k])) for k in range(PEER_RUNS)]
        theirs = RUNS * min(seconds for seconds, _ in pairs)
        ends = np.array([end[:3] for _, end in pairs])
        apart = np.abs(runs.pose[:PEER_RUNS, -1] - ends).max()
        print(f"  {name} run by run: {theirs:.0f} s, ratio {ours / theirs:.2g}")
        lines.append(report(f"{model} against {name}, difference [m, rad]", apart, "", SAME))
        if name == "control":
            lines.append(report(f"{model}, {RUNS} runs over {name}", ours / theirs, "", LIMIT))
    if model == "slipping":
        theirs = RUNS * pybullet_s_time()
        print(f"  PyBullet run by run: {theirs:.0f} s, ratio {ours / theirs:.2g}")
    growth = ours / RUNS / (few / 50)
    return [*lines, report(f"{model}, cost of a run in {RUNS} over that in 50", growth, "", 1.25)]


def measure_plants() -> list[bool]:
    """A step of the plant that lesson 05 steers."""
    lines = []
    for model, limit in (("kinematic", 20), ("linear", 20), ("slipping", 100)):
        plant = SkidSteerPlant(model=model)

        def drive(plant: SkidSteerPlant = plant) -> None:
            for k in range(1000):
                plant.step(0.5, 0.5 if k % 50 else -0.5)

        seconds, _ = best(drive, 5)
        lines.append(report(f"a step of the {model} plant", 1e3 * seconds, "us", limit))
    return lines


def measure_trackers() -> list[bool]:
    """A minute of a figure of eight at 50 Hz, lesson 05's comparison, by each tracker."""
    path = tracking.figure_eight().with_times(10.3 / 60)
    lines = []
    for name, tracker in tracking.TRACKERS.items():

        def drive(tracker: Callable = tracker) -> tracking.Follow:
            plant = SkidSteerPlant(HUSKY, DT, "kinematic")
            return tracking.follow(tracker(), plant, path, mode="trajectory", period=DT)

        seconds, run = best(drive)
        assert len(run.time) > 2600
        lines.append(report(f"a minute at 50 Hz by {name}", seconds, "s", 0.4))
    return lines


def main() -> int:
    rng = np.random.default_rng(0)
    legs = rng.uniform([-1.0, -1.0], [1.0, 1.0], (RUNS, LEGS, 2))
    lines = [line for model in MODELS for line in measure(model, legs)]
    return 0 if all(lines + measure_plants() + measure_trackers()) else 1


if __name__ == "__main__":
    sys.exit(main())

"""Demonstrations: how an operator would dig and load, in x, y, z of the stick's tip and the bucket.

The source drives its machine through hand-placed way-points joined by polynomials and prints only
their durations, 13.68 s to dig and 10.80 s to load, and goals (6.7.3). Here are way-points of our
own for the scene `simulation.LOADING`, joined by quintic splines that start and end at rest. The
dig has the start and the goal of the source. Its loading goal stands so near the truck's side that
the bucket would touch our truck: ours reaches further over it.

Recorded, a movement has uneven times and noise, and no operator does the same twice: `recorded` and
`repetitions` give such demonstrations.

Source: Mastalli 2013, sections 6.7.1 to 6.7.3.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs
from backhoe.planning.dmp.spring import whole_steps

WAY_POINTS = {
    "dig": (
        (0.00, 5.45, -0.40, 1.84, 0.00),
        (3.00, 6.60, -0.42, 2.60, 1.05),
        (5.60, 6.45, -0.44, 1.88, 1.45),
        (8.10, 5.65, -0.46, 1.52, 1.42),
        (10.60, 6.00, -0.48, 0.85, 0.15),
        (13.68, 6.00, -0.50, 2.00, -0.30),
    ),
    "load": (
        (0.00, 6.00, -0.50, 2.00, -0.30),
        (2.60, 5.80, 0.40, 3.20, -0.44),
        (5.20, 4.50, 3.60, 3.80, -0.42),
        (7.80, 1.60, 5.40, 3.90, -0.20),
        (9.30, 1.20, 5.70, 3.88, 0.50),
        (10.80, 1.20, 5.70, 3.80, 1.70),
    ),
}
"""Time [s], x, y, z of the stick's tip in the base frame [m], angle of the bucket's joint [rad]."""

STEPS = (0.016, 0.151)
"""Shortest and longest time between two samples of a recording [s]."""

NOISE = (0.005, 0.005, 0.005, 0.005)
"""Standard deviation of a recorded sample [m, m, m, rad]."""

SPREAD = (0.05, 0.05, 0.05, 0.03)
"""Standard deviation of an operator's way-points from one time to the next [m, m, m, rad]."""

LONGEST = 1e5
"""Duration that is recorded at most [s]."""

HASTE = 0.06
"""Standard deviation of an operator's duration, as a share of it."""


class Demonstration(NamedTuple):
    """Times (N,) [s], from 0 on, and positions there (N, 4): x, y, z [m] and the bucket [rad]."""

    times: NDArray
    positions: NDArray


def through(times: ArrayLike, points: ArrayLike, dt: float = 0.01) -> Demonstration:
    """The quintic spline through way-points of your own, at rest at both ends, sampled evenly.

    Args:
        times: of the way-points, rising from 0, shape (n,) [s].
        points: x, y, z of the stick's tip [m] and the bucket's angle [rad], shape (n, 4).
        dt: time between two samples [s]; shortened a little where the duration needs it.

    Returns:
        Times and positions.

    Raises:
        ValueError: other shapes, times that do not rise from 0, a step that is not positive, longer
            than the movement or less than a millionth of it.
    """
    from scipy.interpolate import make_interp_spline

    times = inputs.times(times, "times")
    points = inputs.numbers(points, "points", (len(times), 4))
    if times[0] != 0:
        raise ValueError(f"times must rise from 0, got {times}")
    if inputs.positive(dt, "dt", "s") > times[-1]:
        raise ValueError(f"dt must be at most the movement's {times[-1]:.2f} s, got {dt:g}")
    whole_steps(times[-1], dt)  # not too many
    still = [(1, np.zeros(4)), (2, np.zeros(4))]
    spline = make_interp_spline(times, points, k=5, bc_type=(still, still))
    t = np.linspace(0.0, times[-1], round(times[-1] / dt) + 1)
    return Demonstration(t, spline(t))


def demonstration(name: str = "dig", dt: float = 0.01) -> Demonstration:
    """The clean demonstration of a name in `WAY_POINTS`, sampled evenly.

    Args:
        name: "dig" or "load".
        dt: time between two samples [s]; shortened a little where the duration needs it.

    Returns:
        Times and positions; speed and acceleration are zero at both ends.

    Raises:
        ValueError: another name, or a step that is not positive or longer than the movement.
    """
    way = np.array(WAY_POINTS[inputs.choice(name, "name", WAY_POINTS)])
    return through(way[:, 0], way[:, 1:], dt)


def recorded(demo: Demonstration, seed: int = 0, noise: tuple[float, ...] = NOISE) -> Demonstration:
    """A demonstration as a logger keeps it: at uneven times, each sample with noise.

    Args:
        demo: the movement.
        seed: of times and noise.
        noise: standard deviation in each dimension [m, m, m, rad].

    Returns:
        Times with steps within `STEPS` (the last one up to their sum) and noisy positions.

    Raises:
        ValueError: other shapes, times that do not rise, a negative noise, no valid seed.
        TypeError: demo is no pair.
    """
    if len(inputs.instance(demo, "demo", (tuple, list))) != 2:
        raise ValueError(f"demo must be times and positions, got {len(demo)} things")
    times = inputs.times(demo[0], "the times of demo")
    positions = inputs.numbers(demo[1], "the positions of demo", (len(times), 4))
    inputs.number(times[-1] - times[0], "the duration of demo", "s", most=LONGEST)
    noise = inputs.numbers(noise, "noise", (4,), meaning="standard deviations")
    if noise.min() < 0:
        raise ValueError(f"noise must not be negative, got {noise}")
    rng = np.random.default_rng(inputs.whole(seed, "seed", least=0))
    shortest, longest = STEPS
    count = int((times[-1] - times[0]) / shortest) + 2
    stamps = times[0] + np.cumsum(shortest + (longest - shortest) * rng.beta(0.7, 3.0, count))
    stamps = np.r_[times[0], stamps[stamps < times[-1] - shortest], times[-1]]
    seen = np.stack([np.interp(stamps, times, column) for column in positions.T], axis=1)
    return Demonstration(stamps - times[0], seen + noise * rng.standard_normal(seen.shape))


def repetitions(name: str = "dig", count: int = 5, seed: int = 0) -> list[Demonstration]:
    """The same work `count` times, as one operator does it: other ways, other haste, recorded.

    Args:
        name: "dig" or "load".
        count: how many, 1 to 10,000.
        seed: of the spread, the times and the noise.

    Returns:
        Recorded demonstrations, each with times of its own; start and goal vary too.

    Raises:
        ValueError: another name, no count, no valid seed.
    """
    way = np.array(WAY_POINTS[inputs.choice(name, "name", WAY_POINTS)])
    count = inputs.whole(count, "count", least=1, most=10_000)
    rng = np.random.default_rng(inputs.whole(seed, "seed", least=0))
    done = []
    for _ in range(count):
        times = way[:, 0] * np.exp(HASTE * rng.standard_normal())
        points = way[:, 1:] + SPREAD * rng.standard_normal((len(way), 4))
        done.append(recorded(through(times, points, 0.01), int(rng.integers(1 << 31))))
    return done

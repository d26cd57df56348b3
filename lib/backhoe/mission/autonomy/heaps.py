"""Ten heaps to choose on: how much soil a choice of strips brings in a given time.

The machine is led along its strokes as in `mission.worksite`, so that a job of minutes takes a
second; what it knows of the ground is what its eyes could see, with noise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from backhoe.arm.kinematics import inverse_kinematics, pose
from backhoe.basics import inputs
from backhoe.machine import BACKHOE
from backhoe.mission.autonomy import choice
from backhoe.mission.autonomy.choice import DIRECTIONS, REACHES, Strip
from backhoe.mission.parts import smooth_trajectory
from backhoe.simulation.scene import LOADING, Heap, Scene, untouched_ground
from backhoe.simulation.soil import SANDY_LOAM
from backhoe.simulation.trial import TICK, Trial, dig

SHIFT = 180.0
"""Working time of a job [s]; what is not in the truck by then does not count."""

EYE = 3.4
"""Height of the lasers above the ground [m]."""

NOISE = 0.02
"""Of a height in what the machine sees, standard deviation [m]."""

FORM = "dig_choice(heights, deviation, directions, reaches) -> Strip or None"


@dataclass(frozen=True, eq=False)
class Loads:
    """A job of some `seconds`: the `strips` and each one's `digs`; the soil that it was `expected`
    to bring, (n,) [m^3]; the `times` at which it was in the truck, (n,) [s]; and the polar heights
    that were seen `before`, (n, directions, reaches) [m]."""

    seconds: float
    strips: tuple[Strip, ...]
    digs: tuple[Trial, ...]
    expected: NDArray
    times: NDArray
    before: NDArray

    @property
    def fills(self) -> NDArray:
        """Soil that each strip brought, (n,) [m^3]."""
        return np.array([one.soil for one in self.digs])

    @property
    def rate(self) -> float:
        """Soil in the truck per minute of the job [m^3/min]."""
        return float(self.fills.sum()) / self.seconds * 60


def heap_site(seed: int) -> Scene:
    """One to three heaps of any size around the machine, the truck on the left."""
    rng = np.random.default_rng(inputs.whole(seed, "seed", least=0))
    heaps = []
    for _ in range(rng.integers(1, 4)):
        r, direction = rng.uniform(5.0, 6.4), rng.uniform(-1.0, 0.6)
        x, y = BACKHOE.base.offset + r * cos(direction), r * sin(direction)
        heaps.append(Heap(x, y, rng.uniform(0.6, 1.3), rng.uniform(1.4, 2.3)))
    return Scene((-3.0, -8.0), 181, 161, 0.08, tuple(heaps), LOADING.truck)


def job(dig_choice: Callable, seed: int = 0, seconds: float = SHIFT) -> Loads:
    """Dig where a part says, again and again, until the time is over.

    Args:
        dig_choice: the part; `FORM` is its call. None from it ends the job.
        seed: of heaps and noise.
        seconds: the shift; a bucket that would be late stays behind.

    Raises:
        TypeError: no function.
        ValueError: the part returns something else, or a strip out of the arm's reach.
    """
    inputs.function(dig_choice, "dig_choice", FORM)
    inputs.positive(seconds, "seconds", "s")
    ground = untouched_ground(heap_site(seed), BACKHOE, seed, TICK, SANDY_LOAM)
    rng, now, done = np.random.default_rng(seed), 0.0, []
    while True:
        heights, _ = choice.polar(ground.terrain)
        heights = seen(heights) + NOISE * rng.normal(size=heights.shape)
        deviation = np.where(np.isnan(heights), np.nan, NOISE)
        strip = dig_choice(heights.copy(), deviation, DIRECTIONS.copy(), REACHES.copy())
        if strip is None:
            break
        strip = Strip(*inputs.numbers(strip, "your strip", (3,), meaning=FORM).tolist())
        now += choice.cycle_time(strip.direction)
        if now > seconds:
            break
        polar = heights, DIRECTIONS, REACHES
        times, path = choice.stroke(strip, *polar)
        t = np.linspace(0.0, times[-1], 200)
        q, _ = smooth_trajectory(times, inverse_kinematics(path), t)
        one = dig(pose(q), t, ground=ground)
        done.append((strip, one, choice.expected_fill(strip, *polar), now, heights))
    strips, digs, *columns = zip(*done, strict=True) if done else ((), (), (), (), ())
    return Loads(seconds, tuple(strips), tuple(digs), *map(np.array, columns))


def seen(heights: NDArray) -> NDArray:
    """What an eye above the swing axis sees past what is nearer.

    Args:
        heights: of `DIRECTIONS` and `REACHES`, shape (n, m) [m].

    Returns:
        The heights, NaN where something hides them, shape (n, m) [m].
    """
    slope = (heights - EYE) / REACHES
    highest = np.maximum.accumulate(np.nan_to_num(slope, nan=-np.inf), axis=1)
    return np.where(slope >= highest - 0.01, heights, np.nan)

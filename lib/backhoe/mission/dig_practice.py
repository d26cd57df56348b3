"""A dig that gets better by practice: what may change of a primitive, and what a try costs.

The primitive is a demonstrated dig. Nine parameters change it: by how much its path is moved ahead,
up and in the bucket's angle around three moments. They change the primitive's weights: for a stiff
spring a weight, times the phase at its kernel, is a way in metres.

A cost is a sum of shares: of a full bucket that is missing or was spilled, and of the energy and
the force of the soil that count as much as an empty bucket. A path that cannot be driven, or with
which the machine would tip, fails: its cost is infinite.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs
from backhoe.machine import BACKHOE
from backhoe.mission.parts import TIPPING, WayPoint, hand_made_plan
from backhoe.planning.dmp import DMP
from backhoe.planning.dmp.demonstrations import demonstration
from backhoe.planning.foresight import foresee
from backhoe.simulation.clock import STEP
from backhoe.simulation.scene import LOADING, untouched_ground
from backhoe.simulation.soil import soil_of
from backhoe.simulation.soil.bucket_fill import BucketFill
from backhoe.simulation.trial import TICK, Trial, dig_many

__all__ = ["MOMENTS", "SPREAD", "DigCost", "DigPractice", "Practised", "dig_cost", "practised"]

FILE = Path(__file__).resolve().parents[3] / "data" / "practice" / "dig.csv"

MOMENTS = (0.31, 0.48, 0.66)
"""Shares of the duration around which the path is moved: cutting in, pulling, curling."""

WIDTH = 0.088
"""Standard deviation of each of these bumps, as a share of the duration."""

MOVED = (0, 2, 3)
"""Dimensions that are moved: x, z [m] and the bucket's angle [rad]."""

SPREAD = 0.16
"""Standard deviation of a first try in each parameter [m, rad]."""

ENERGY = 500e3
"""Energy that counts as much as an empty bucket [J]."""

FORCE = 300e3
"""Peak force of the soil that counts as much as an empty bucket [N]."""


class DigCost(NamedTuple):
    """What a try costs, in shares [1]."""

    missing: float
    energy: float
    force: float
    spilled: float

    @property
    def total(self) -> float:
        """The sum [1]."""
        return sum(self)


def dig_cost(trial: Trial, full: float) -> DigCost:
    """Cost of a try, with the soil of a full bucket [m^3]."""
    return DigCost(
        max(0.0, 1.0 - trial.soil / full),
        trial.energy / ENERGY,
        trial.peak_force / FORCE,
        trial.spilled / full,
    )


class Practised(NamedTuple):
    """What practice with one method brought, a row a seed, seeds from 0 on.

    Attributes:
        parameters: best of each, shape (seeds, 9) [m, rad].
        costs: of all tries in their order, shape (seeds, tries) [1]; inf where one failed.
    """

    parameters: NDArray
    costs: NDArray


def practised(file: str | Path | None = None) -> dict[str, Practised]:
    """The stored experiment: PI2, PoWER and CMA-ES on the demonstrated dig in sandy loam.

    Args:
        file: as `tests/planning/write_practice.py` writes it; default `FILE`.

    Returns:
        Method -> parameters (seeds, 9) [m, rad] and costs (seeds, tries) [1].

    Raises:
        FileNotFoundError: there is no such file.
    """
    file = FILE if file is None else Path(file)
    rows = [line.split(",") for line in file.read_text(encoding="utf-8").splitlines()]
    rows = [row for row in rows if not row[0].startswith(("#", "method"))]
    numbers = np.array([row[2:] for row in rows], dtype=float)
    found = {}
    for method in dict.fromkeys(row[0] for row in rows):
        mine = numbers[[row[0] == method for row in rows]]
        found[method] = Practised(mine[:, :9], mine[:, 9:])
    return found


class DigPractice:
    """The job to get better at; `costs` is what `planning.improve` takes.

    Args:
        soil: a name in `simulation.soil.SOILS`.
        seed: of the bumps on the heap.
        primitive: learnt, of x, y, z of the stick's tip [m] and the bucket's angle [rad]; the
            demonstrated dig if None.
        processes: how many dig side by side; one a core if None.

    Raises:
        ValueError: an unknown soil, or a primitive of other dimensions.
        TypeError: primitive is no DMP.
    """

    def __init__(
        self,
        soil: str = "sandy loam",
        seed: int = 0,
        primitive: DMP | None = None,
        processes: int | None = None,
    ) -> None:
        self.world = {"soil": soil_of(soil), "seed": inputs.whole(seed, "seed", least=0)}
        if primitive is None:
            shown = demonstration("dig")
            primitive = DMP().learn(shown.positions, shown.times)
        self.primitive = inputs.instance(primitive, "primitive", DMP)
        inputs.numbers(primitive.goal, "the primitive's goal", (4,))
        self.processes = processes
        self.start = np.zeros(len(MOMENTS) * len(MOVED))

    @cached_property
    def full(self) -> float:
        """Soil in a heaped bucket [m^3]."""
        return BucketFill(BACKHOE.shell, self.world["soil"].repose).heaped

    @cached_property
    def _bumps(self) -> NDArray:
        """Weights that move the path by 1 around each moment, shape (moments, kernels)."""
        kernels = self.primitive.kernels
        fall, share = -np.log(kernels.end_phase), kernels.centres
        if kernels.spacing != "time":
            share = -np.log(share) / fall
        away = (share - np.array(MOMENTS)[:, None]) / WIDTH
        return np.exp(-0.5 * away**2 + fall * share)

    def improved(self, parameters: ArrayLike) -> DMP:
        """The primitive with parameters (9,): offsets in x, z [m] and bucket [rad], moment by
        moment."""
        shape = (len(MOMENTS) * len(MOVED),)
        moved = inputs.numbers(parameters, "parameters", shape).reshape(len(MOMENTS), len(MOVED))
        weights = self.primitive.weights.copy()
        weights[:, MOVED] += self._bumps.T @ moved
        return self.primitive.with_weights(weights)

    def path(self, parameters: ArrayLike) -> tuple[NDArray, NDArray]:
        """Times (n,) [s] and positions (n, 4) [m, rad] of the dig with parameters (9,) [m, rad]."""
        times, positions, _ = self.improved(parameters).rollout(dt=TICK)
        return times, positions

    def trials(self, tries: ArrayLike) -> list[Trial | None]:
        """The digs of tries (n, 9) [m, rad]; None where a path cannot be driven."""
        tries = inputs.numbers(tries, "tries", ("n", len(self.start)), meaning="offsets")
        paths = [self.path(one) for one in tries]
        able = [foresee(positions, times).ok for times, positions in paths]
        done = dig_many(
            [path[1] for path, good in zip(paths, able, strict=True) if good],
            paths[0][0],
            processes=self.processes,
            **self.world,
        )
        rest = iter(done)
        return [next(rest) if good else None for good in able]

    def costs(self, tries: ArrayLike) -> NDArray:
        """Cost of each try (n, 9) [m, rad], shape (n,) [1]; inf where it failed or would tip."""
        return np.array([self._cost(trial) for trial in self.trials(tries)])

    def heap(self, y: float = -0.45) -> NDArray:
        """The untouched ground along the stroke, at y [m]: x and height, shape (n, 2) [m]."""
        world = self.world
        ground = untouched_ground(LOADING, BACKHOE, world["seed"], STEP, world["soil"])
        x, rows = ground.terrain.grid()
        row = int(np.abs(rows[:, 0] - y).argmin())
        near = (x[row] > 3.0) & (x[row] < 9.0)
        return np.c_[x[row], ground.terrain.heights[row]][near]

    def plan(self, parameters: ArrayLike, step: float = 0.5) -> list[WayPoint]:
        """Way-points for `mission.run`: the dig with parameters (9,) [m, rad] in steps [s], then
        the way to the truck and back as in `hand_made_plan`; whole millimetres and milliradians,
        so that the last digits of a processor's sums do not reach the soil."""
        positions = np.round(self.path(parameters)[1], 3)
        every = max(1, round(step / TICK))
        rows = positions[every::every]
        if (len(positions) - 1) % every:
            rows = np.concatenate([rows, positions[-1:]])
        first, *_ = hand_made_plan(0)
        last = hand_made_plan(0)[-len(TIPPING) :]
        to_start = WayPoint(first.name, first.time, tuple(positions[0]))
        return [to_start, *(WayPoint("dig", step, tuple(row)) for row in rows), *last]

    def _cost(self, trial: Trial | None) -> float:
        if trial is None or trial.tipped or trial.saturated > 0.0:
            return np.inf
        return dig_cost(trial, self.full).total

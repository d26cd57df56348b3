"""What a run is worth: soil, time and errors, beside the library's own run."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from backhoe import sim
from backhoe.machine import Machine
from backhoe.mission.drive import Run, run


@dataclass(frozen=True)
class Score:
    """A run in five numbers, beside the reference run.

    `soil` loaded into the truck [m^3], `time` [s], `waypoint_error` the mean distance from a wanted
    to a reached stick's tip [m], `bucket_error` the same of the bucket joint [rad], `tracking` the
    root mean square of q_ref - q while the bucket is empty and in the air [rad].
    """

    soil: float
    time: float
    waypoint_error: float
    bucket_error: float
    tracking: float
    swapped: tuple[str, ...] = ()
    reference: Score | None = None

    def __str__(self) -> str:
        columns = [self] if self.reference is None else [self, self.reference]
        rows = [
            ("soil in the truck [m^3]", "{:.1f}", lambda score: score.soil),
            ("time [s]", "{:.1f}", lambda score: score.time),
            ("way-point error [cm]", "{:.0f}", lambda score: 100 * score.waypoint_error),
            ("bucket error [deg]", "{:.0f}", lambda score: np.degrees(score.bucket_error)),
            ("error in the air [deg]", "{:.1f}", lambda score: np.degrees(score.tracking)),
        ]
        heads = ["yours" if self.swapped else "library", "library"][: len(columns)]
        parts = ", ".join(self.swapped) or "none"
        lines = [f"swapped in: {parts}", " " * 24 + "".join(f"{head:>10}" for head in heads)]
        lines += [
            f"{label:<24}" + "".join(f"{form.format(value(score)):>10}" for score in columns)
            for label, form, value in rows
        ]
        return "\n".join(lines)


def _measure(run: Run) -> Score:
    distance = np.linalg.norm(run.reached[:, :3] - run.wanted[:, :3], axis=-1)
    error = run.q_ref - run.q
    return Score(
        soil=float(run.truck_volume[-1] - run.truck_volume[0]),
        time=float(run.time[-1]),
        waypoint_error=float(distance.mean()),
        bucket_error=float(np.abs(run.reached[:, 3] - run.wanted[:, 3]).mean()),
        tracking=float(np.sqrt(np.mean(error[run.in_the_air] ** 2))),
        swapped=run.swapped,
    )


@lru_cache(maxsize=8)
def _reference_score(cycles: int, machine: Machine, scene: sim.Scene, backend: str) -> Score:
    with sim.open_world(machine, backend=backend, scene=scene) as world:
        return _measure(run(cycles=cycles, world=world))


def score(run: Run) -> Score:
    """Measure a run beside the same number of cycles with the library's parts only.

    The reference runs in a new world of the same scene, by the same backend if it is the library's.

    Args:
        run: what `mission.run` returned.

    Returns:
        The score; `print` shows it beside the reference.
    """
    measured = _measure(run)
    if not run.swapped:
        return measured
    backend = run.backend if run.backend in sim.BACKENDS else "auto"
    reference = _reference_score(run.cycles, run.machine, run.scene, backend)
    return Score(**{**vars(measured), "reference": reference})

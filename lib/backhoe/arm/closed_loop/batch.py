"""What a batch of closed-loop simulations leaves: measures of each run, and some whole runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Trajectory(NamedTuple):
    """One run on its recorded samples, up to its end or to where it was stopped.

    `t` (m,) [s]; `q`, `dq` (m, 4) [rad, rad/s]; `torque` (m, 4) [N m], the one applied from this
    sample on; `q_ref` (m, 4) [rad].
    """

    t: NDArray
    q: NDArray
    dq: NDArray
    torque: NDArray
    q_ref: NDArray

    @property
    def error(self) -> NDArray:
        """q_ref - q, shape (m, 4) [rad]."""
        return self.q_ref - self.q


@dataclass(frozen=True, eq=False)
class Batch:
    """Measures of n runs; those of a run that diverged are infinite.

    Attributes:
        rms_error: root of the mean square of q_ref - q over the samples, shape (n, 4) [rad].
        peak_error: largest |q_ref - q|, shape (n, 4) [rad].
        final_error: q_ref - q at the last sample, shape (n, 4) [rad].
        peak_torque: largest |tau|, shape (n, 4) [N m].
        effort: integral of tau^2 over time, shape (n, 4) [N^2 m^2 s].
        saturated: share of the samples in which the torque was at its limit, shape (n, 4).
        overrun: how far a joint went outside its range, shape (n, 4) [rad]; 0 if it never did. The
            stops are not modelled: such a run means nothing after that.
        diverged: whether the run was stopped, shape (n,).
        stopped_at: where it ended, shape (n,) [s]: the end of the movement unless it diverged.
        trajectories: recorded runs by their index.
    """

    rms_error: NDArray
    peak_error: NDArray
    final_error: NDArray
    peak_torque: NDArray
    effort: NDArray
    saturated: NDArray
    overrun: NDArray
    diverged: NDArray
    stopped_at: NDArray
    trajectories: dict[int, Trajectory] = field(repr=False)

    def __len__(self) -> int:
        return len(self.diverged)

    def trajectory(self, index: int) -> Trajectory:
        """The recorded run of this index.

        Raises:
            KeyError: that run was not recorded.
        """
        if index not in self.trajectories:
            kept = ", ".join(map(str, self.trajectories)) or "none"
            raise KeyError(
                f"run {index} was not recorded: name it in record=[{index}] (recorded: {kept})"
            )
        return self.trajectories[index]


def joined(batches: Sequence[Batch]) -> Batch:
    """One batch out of several, in their order."""
    measures = {
        item.name: np.concatenate([getattr(batch, item.name) for batch in batches])
        for item in fields(Batch)
        if item.name != "trajectories"
    }
    starts = np.cumsum([0, *map(len, batches)]).tolist()
    trajectories = {
        start + index: trajectory
        for start, batch in zip(starts, batches, strict=False)
        for index, trajectory in batch.trajectories.items()
    }
    return Batch(**measures, trajectories=trajectories)

"""What pushes a primitive aside while it runs: obstacles of a map, limits of its dimensions.

Each is a `coupling` of `DMP.rollout`, and gives an acceleration as if a second spring, `gain` times
as stiff as the primitive's own, held the point away: it is left where both are in balance. It is
asked once a step and held: steps longer than a fifth of tau / sqrt(K) let it ring.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs
from backhoe.perception.distance_field import DistanceField
from backhoe.planning.dmp.primitive import DMP
from backhoe.planning.dmp.remedies import Coupling


def _stiffness(dmp: DMP, gain: float, duration: float | None) -> float:
    """gain K / tau^2 of the primitive when it lasts so long [1/s^2]."""
    inputs.instance(dmp, "dmp", DMP)
    whole = dmp.duration if duration is None else duration
    stretch = inputs.number(whole, "duration", "s", least=1e-6, most=1e9) / dmp.duration
    return inputs.positive(gain, "gain") * dmp.stiffness / (dmp.tau * stretch) ** 2


def keep_clear(
    dmp: DMP,
    field: DistanceField,
    clearance: float,
    gain: float = 4.0,
    duration: float | None = None,
) -> Coupling:
    """Pushes x, y, z, the first three dimensions, away from what is nearer than the clearance.

    Args:
        dmp: which is pushed.
        field: distances to the obstacles, in the frame of the path [m].
        clearance: where the push begins [m]; 1 / (1 + gain) of what the path lacks is left lacking.
        gain: of the second spring over the first.
        duration: of the roll-out [s]; that of the demonstration if None.

    Raises:
        TypeError: no primitive, no field.
        ValueError: a number that is not positive.
    """
    inputs.instance(field, "field", DistanceField)
    clearance = inputs.positive(clearance, "clearance", "m")
    stiffness = _stiffness(dmp, gain, duration)

    def coupling(_t: float, x: NDArray, _v: NDArray) -> NDArray:
        push = np.zeros(x.shape)
        distance, away = field.query(x[:3], beyond=np.inf)
        push[:3] = stiffness * max(clearance - float(distance), 0.0) * away
        return push

    return coupling


def keep_within(
    dmp: DMP,
    lower: ArrayLike,
    upper: ArrayLike,
    gain: float = 4.0,
    duration: float | None = None,
) -> Coupling:
    """Pushes each dimension back between its limits, such as those of the bucket's joint.

    Args:
        dmp, gain, duration: as for `keep_clear`.
        lower, upper: limits, infinite where there is none, shapes (d,) [unit].

    Raises:
        TypeError: no primitive.
        ValueError: another shape, a number that is not positive, limits the wrong way round.
    """
    stiffness = _stiffness(dmp, gain, duration)
    lower = inputs.numbers(lower, "lower", dmp.start.shape, finite=False)
    upper = inputs.numbers(upper, "upper", dmp.start.shape, finite=False)
    if not (lower <= upper).all():
        raise ValueError(f"lower must be at most upper, got {lower} and {upper}")
    return lambda _t, x, _v: stiffness * (np.clip(x, lower, upper) - x)

"""The law of `loops`, compiled: it runs a thousand times a second."""

from __future__ import annotations

from backhoe.arm.dynamics import terms
from backhoe.basics.engine import compiled
from backhoe.mission.autonomy import loops
from backhoe.simulation import moving_base, standing

hold, *_ = compiled(
    loops.hold, terms.gravity_torques, terms.vectors, moving_base.vectors_at, standing.arm_in
)

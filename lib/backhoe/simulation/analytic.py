"""The simulation without PyBullet: the exact equations of motion (`moving_base`), integrated.

There are no contacts, except that the tracks rest on the ground and the bucket digs, and no
cameras.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from backhoe.arm import dynamics
from backhoe.arm.dynamics import terms
from backhoe.simulation import engine
from backhoe.simulation.loop import Loop
from backhoe.simulation.moving_base import carrier_of


class AnalyticWorld(Loop):
    """A `Loop` that integrates the exact dynamics by semi-implicit Euler; arguments as there."""

    backend = "analytic"

    def _integrate(self) -> None:
        q, dq, forces = self._state.q, self._state.dq, self._state.forces
        if self.base == "fixed":
            ddq = np.zeros(7)
            ddq[3:] = dynamics.forward_dynamics(q[3:], dq[3:], forces[3:], machine=self._loaded)
        else:
            M, left = np.empty((7, 7)), forces.copy()
            engine.balance(self._arm, self._carrier, q, dq, M, left)
            ddq = np.linalg.solve(M, left)
        dq += self.dt * ddq
        q += self.dt * dq

    def _carry(self, payload: float) -> None:
        bucket = replace(self.machine.bucket, mass=self.machine.bucket.mass + payload)
        self._loaded = replace(self.machine, bucket=bucket)
        self._arm, self._carrier = terms.arm_of(self._loaded), carrier_of(self._loaded)

"""The law that holds the arm, compiled.

Imported on first use: Numba takes half a second to load.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from backhoe.dynamics import terms

_vectors = njit(terms.vectors)
_gravity_torques = njit(terms.gravity_torques)


@njit(cache=True)
def hold(arm, q_ref, kp, kd, q, dq):
    """Joint torques (4,): gravity torque at q and a PD towards q_ref at rest."""
    p2 = q[1] + arm.o2
    p3 = p2 + q[2] + arm.o3
    p4 = p3 + q[3] + arm.o4
    v = _vectors(arm, np.cos(p2), np.sin(p2), np.cos(p3), np.sin(p3), np.cos(p4), np.sin(p4))
    torque = kp * (q_ref - q) - kd * dq
    g2, g3, g4 = _gravity_torques(arm, v)
    torque[1] += g2
    torque[2] += g3
    torque[3] += g4
    return torque

"""How the arm is carried when the machine travels."""

from __future__ import annotations

import numpy as np

POSTURE = np.radians([-90.0, 50.0, -60.0, 60.0])
"""Joint angles swing, boom, stick, bucket [rad]: arm forward, boom up, the rest folded in; ours."""
POSTURE.flags.writeable = False

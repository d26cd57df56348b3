"""Laser scanners that nod on a machine that moves: when and where each beam points.

- `lines`: times, nod and directions of the beams of a line
- `motion`: where the machine was at each of those times, and the points that ranges then give

Source: Mastalli 2013, section 5.1; it gives no equations for this.
"""

from backhoe.perception.laser.lines import beam_angles, beam_times, directions, nod_angles
from backhoe.perception.laser.motion import Motion, deskew, sensor_poses

__all__ = [
    "Motion",
    "beam_angles",
    "beam_times",
    "deskew",
    "directions",
    "nod_angles",
    "sensor_poses",
]

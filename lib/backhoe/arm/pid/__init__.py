"""PID control, one class for each way in which the course meets it.

- `joint`: the arm's PID, whose derivative comes from measured joint speeds
- `digital`: a sampled PID that makes its own derivative, filtered, of reference and measurement
"""

from backhoe.arm.pid.digital import DigitalPID
from backhoe.arm.pid.joint import ARM_GAINS, PID, Gains

__all__ = ["ARM_GAINS", "PID", "DigitalPID", "Gains"]

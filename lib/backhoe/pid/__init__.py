"""PID control, one class for each way in which the course meets it.

- `joint`: the arm's PID, whose derivative comes from measured joint speeds
- `digital`: a sampled PID that makes its own derivative, filtered, of reference and measurement
- `hold`: a value that is read less often than the controller runs
"""

from backhoe.pid.digital import DigitalPID
from backhoe.pid.hold import SampleHold
from backhoe.pid.joint import ARM_GAINS, PID, Gains

__all__ = ["ARM_GAINS", "PID", "DigitalPID", "Gains", "SampleHold"]

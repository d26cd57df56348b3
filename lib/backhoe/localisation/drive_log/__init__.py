"""Logs of drives: CSV files with the units in the header, read without guessing.

    # seed 4; python -m backhoe.localisation.drives
    t [s],left [rad],right [rad],gyro [rad/s],x [m],y [m],psi [rad]
    0.00,0.0,0.0,0.001,0.0,0.0,0.0

- `log`: what a log is, `write`; `reading`: from a file, with everything wrong named by line and
  column; `plausible`: units that the numbers contradict, counters that were reset
"""

from backhoe.localisation.drive_log.log import DriveLog, write
from backhoe.localisation.drive_log.plausible import LIMITS
from backhoe.localisation.drive_log.reading import read

__all__ = ["LIMITS", "DriveLog", "read", "write"]

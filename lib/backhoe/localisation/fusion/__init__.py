"""Where the machine is: odometry and a filter on the same drives, scored and counted.

    cycle            100 Hz and 30 Hz: what of the samples goes into one cycle
    model            motion by the encoders with slip and bias, and what the sensors see
    estimators       dead reckoning, and the filter that takes increments for increments
    fixes            positions by a total station
    scores           RMSE by Algorithm 2 corrected, and what "improvement" means
    monte_carlo      many runs: NEES and NIS with their bands
    observability    what no measurement shows
    online           the parts of the driving machine, sample by sample

Source: Mastalli 2013, chapter 4.
"""

from backhoe.localisation.fusion.cycle import CYCLE_RATE, Increments, cycles, increments
from backhoe.localisation.fusion.estimate import Estimate
from backhoe.localisation.fusion.estimators import (
    GYRO_PERIOD,
    START_STD,
    TURNING_PRIOR,
    dead_reckoning,
    pose_filter,
)
from backhoe.localisation.fusion.fixes import STATION_STD, Fix, total_station
from backhoe.localisation.fusion.model import Model
from backhoe.localisation.fusion.monte_carlo import RUNS, MonteCarlo, monte_carlo, starts
from backhoe.localisation.fusion.observability import Unobservable, unobservable
from backhoe.localisation.fusion.online import Localiser, Odometer
from backhoe.localisation.fusion.scores import Improvement, improvement, pose_rmse, rmse

__all__ = [
    "CYCLE_RATE",
    "GYRO_PERIOD",
    "RUNS",
    "START_STD",
    "STATION_STD",
    "TURNING_PRIOR",
    "Estimate",
    "Fix",
    "Improvement",
    "Increments",
    "Localiser",
    "Model",
    "MonteCarlo",
    "Odometer",
    "Unobservable",
    "cycles",
    "dead_reckoning",
    "improvement",
    "increments",
    "monte_carlo",
    "pose_filter",
    "pose_rmse",
    "rmse",
    "starts",
    "total_station",
    "unobservable",
]

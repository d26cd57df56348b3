"""Where the machine is: odometry and a filter on the same drives, scored and counted.

    sampling         100 Hz and 30 Hz: what of the samples goes into one cycle
    model            motion by the encoders with slip and bias, and what the sensors see
    honest           dead reckoning, and the filter that takes increments for increments
    fixes            total station and landmarks
    scores           RMSE by Algorithm 2 corrected, and what "improvement" means
    monte_carlo      many runs: NEES and NIS with their bands
    observability    what no measurement shows
    online           the parts of the driving machine, sample by sample

Source: Mastalli 2013, chapter 4.
"""

from backhoe.localisation.fusion.estimate import Estimate
from backhoe.localisation.fusion.fixes import (
    LANDMARK_STD,
    STATION_STD,
    Fix,
    landmarks,
    total_station,
)
from backhoe.localisation.fusion.honest import (
    LISTENING,
    START_STD,
    TURNING_PRIOR,
    dead_reckoning,
    honest,
)
from backhoe.localisation.fusion.model import Model
from backhoe.localisation.fusion.monte_carlo import RUNS, MonteCarlo, monte_carlo, starts
from backhoe.localisation.fusion.observability import Hidden, hidden
from backhoe.localisation.fusion.online import Localiser, Odometer
from backhoe.localisation.fusion.sampling import RATE, Increments, cycles, increments
from backhoe.localisation.fusion.scores import Improvement, improvement, pose_rmse, rmse

__all__ = [
    "LANDMARK_STD",
    "LISTENING",
    "RATE",
    "RUNS",
    "START_STD",
    "STATION_STD",
    "TURNING_PRIOR",
    "Estimate",
    "Fix",
    "Hidden",
    "Improvement",
    "Increments",
    "Localiser",
    "Model",
    "MonteCarlo",
    "Odometer",
    "cycles",
    "dead_reckoning",
    "hidden",
    "honest",
    "improvement",
    "increments",
    "landmarks",
    "monte_carlo",
    "pose_rmse",
    "rmse",
    "starts",
    "total_station",
]

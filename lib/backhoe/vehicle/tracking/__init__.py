"""Driving along paths and trajectories: what is driven, what drives it, how well it went.

- `path`, `geometries`, `waypoint_file`: way-points and times, drawn, read and written
- `protocol`: what a tracker and a plant are; `ideal_plant`: the plainest plant
- `pose_error`, `limits`: errors of a pose, speeds that the wheels can do
- `pid_tracker`, `scaglia_taylor`, `scaglia_linear`, `scaglia_runge_kutta`, `pure_pursuit`: trackers
- `goals`, `follow`: runs; `polyline`, `foot`, `metrics`, `compare`: how well they went
"""

from backhoe.vehicle.tracking.assessment import Assessment, assess, time_lag
from backhoe.vehicle.tracking.compare import Comparison, compare
from backhoe.vehicle.tracking.follow import ARRIVAL, Follow, follow
from backhoe.vehicle.tracking.geometries import circle, figure_eight, from_points, square
from backhoe.vehicle.tracking.ideal_plant import IdealPlant, arc
from backhoe.vehicle.tracking.limits import Limits
from backhoe.vehicle.tracking.metrics import Metrics, metrics
from backhoe.vehicle.tracking.path import Path
from backhoe.vehicle.tracking.pid_tracker import PIDTracker
from backhoe.vehicle.tracking.polyline import arc_length, distances, distances_to_samples, length
from backhoe.vehicle.tracking.pose_error import PoseErrors, pose_errors
from backhoe.vehicle.tracking.protocol import Goal, Plant, Tracker
from backhoe.vehicle.tracking.pure_pursuit import PurePursuit
from backhoe.vehicle.tracking.scaglia_linear import ScagliaLinear
from backhoe.vehicle.tracking.scaglia_runge_kutta import ScagliaRungeKutta, speed_modes
from backhoe.vehicle.tracking.scaglia_taylor import ScagliaTaylor, weight_ratio
from backhoe.vehicle.tracking.tuned import TRACKERS, TRACKERS_ON_TRACKS

__all__ = [
    "ARRIVAL",
    "TRACKERS",
    "TRACKERS_ON_TRACKS",
    "Assessment",
    "Comparison",
    "Follow",
    "Goal",
    "IdealPlant",
    "Limits",
    "Metrics",
    "PIDTracker",
    "Path",
    "Plant",
    "PoseErrors",
    "PurePursuit",
    "ScagliaLinear",
    "ScagliaRungeKutta",
    "ScagliaTaylor",
    "Tracker",
    "arc",
    "arc_length",
    "assess",
    "circle",
    "compare",
    "distances",
    "distances_to_samples",
    "figure_eight",
    "follow",
    "from_points",
    "length",
    "metrics",
    "pose_errors",
    "speed_modes",
    "square",
    "time_lag",
    "weight_ratio",
]

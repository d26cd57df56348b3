"""The whole mission alone: drive to the heap, look, choose, dig, load, until the truck is full.

- `actions`: movements as goals in a queue, with feedback, results and cancelling
- `body`: the machine that moves and minds itself; `eyes`: what it sees
- `cycle`: what to do next, and what to do when something is not as ordered
- `faults`: what can go wrong; `running`: `run` and what it keeps; `report`: its score
- `choice`: where to dig; `heaps`: how much soil a choice brings
- `learnt`: a stroke learnt from an operator; `unattended`: ten missions that nobody watched
- `ways`: from the heap to the truck
"""

from backhoe.mission.autonomy.actions import Action, ActionServer, Feedback, Goal, along, reach
from backhoe.mission.autonomy.choice import (
    DIRECTIONS,
    REACHES,
    Strip,
    best_of,
    best_strip,
    bucket_fill,
    cut_depth,
    cycle_time,
    edge,
    edge_height,
    expected_fill,
    highest_strip,
    polar,
    random_strip,
    side_load,
    stroke,
)
from backhoe.mission.autonomy.cycle import Load, Order
from backhoe.mission.autonomy.faults import FAULTS, Fault
from backhoe.mission.autonomy.heaps import Loads, heap_site, job, seen
from backhoe.mission.autonomy.learnt import learnt_stroke
from backhoe.mission.autonomy.report import AutonomyScore, clearances, report
from backhoe.mission.autonomy.running import AutonomyRun, run, site
from backhoe.mission.autonomy.unattended import unattended

__all__ = [
    "DIRECTIONS",
    "FAULTS",
    "REACHES",
    "Action",
    "ActionServer",
    "AutonomyRun",
    "AutonomyScore",
    "Fault",
    "Feedback",
    "Goal",
    "Load",
    "Loads",
    "Order",
    "Strip",
    "along",
    "best_of",
    "best_strip",
    "bucket_fill",
    "clearances",
    "cut_depth",
    "cycle_time",
    "edge",
    "edge_height",
    "expected_fill",
    "heap_site",
    "highest_strip",
    "job",
    "learnt_stroke",
    "polar",
    "random_strip",
    "reach",
    "report",
    "run",
    "seen",
    "side_load",
    "site",
    "stroke",
    "unattended",
]

"""The parts of one autonomous backhoe, floor by floor.

Nothing is imported here: `from backhoe.arm import kinematics` loads what it names and no more. In
a notebook, cells that take long say so from the first import on.
"""

import sys

__version__ = "0.1.0"

FLOORS = {
    "basics": "tools under all",
    "machine": "the numbers",
    "arm": "how to reach?",
    "vehicle": "how to drive?",
    "localisation": "where am I?",
    "perception": "what is around?",
    "planning": "where to go?",
    "whole_body": "who does what?",
    "view": "what people see",
    "simulation": "how it moves",
    "mission": "the parts joined",
    "lessons": "what serves one lesson",
    "course": "what teaches them",
}
"""The folders of this package, lowest first, and the question of each: a floor imports only those
before it. Lessons open with a picture of the machine's own; perception and planning come with
lessons 08 to 11."""

if "ipykernel" in sys.modules:
    from backhoe.basics.progress import watch_cells

    watch_cells()

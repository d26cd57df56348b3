"""What the figure of digging by feel shows is what it was given."""

from types import SimpleNamespace

import numpy as np
import pytest

from backhoe.lessons.primitives.figures import feeling as figures
from backhoe.mission.feeling import START, STOP
from backhoe.simulation.soil import Rock
from drawn import Panel, ellipse, level, line, proofs

TIME = np.linspace(0.0, 3.0, 7)


def run(shift):
    edge = np.column_stack([6.0 - TIME, 0 * TIME, 0.3 + 0.1 * TIME**2 + shift])
    return SimpleNamespace(time=TIME, strain=0.2 + shift + 0.1 * TIME, edge=edge)


def rock_dug():
    runs = {"blind": run(0.0), "by feel": run(0.2)}
    side = [ellipse((5.0, 0.1), 0.6, 0.6)]
    felt = []
    for name, one in runs.items():
        side.append(line(one.edge[:, 0], one.edge[:, 2], name))
        felt.append(line(one.time, one.strain))
    felt += [level(START), level(STOP), level(1.0)]
    panels = [
        Panel("$x$ [m]", "$z$ of the edge [m]", side),
        Panel("time [s]", "strain [1]", felt),
    ]
    return figures.rock_dug(runs, Rock(5.0, 0.0, 0.1, 0.3)), panels


TestDrawn = proofs(figures, {"rock_dug": rock_dug})


def test_bad_runs_are_named():
    rock = Rock(5.0, 0.0, 0.1, 0.3)
    with pytest.raises(ValueError, match="one or two runs"):
        figures.rock_dug({}, rock)
    with pytest.raises(TypeError, match="rock must be a Rock"):
        figures.rock_dug({"blind": run(0.0)}, (5, 0, 0, 1))

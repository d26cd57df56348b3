"""Drives with a known truth: what encoders and IMU gave, and where the machine really was.

Source: Mastalli 2013, section 4.6 drives three scenarios of which it prints no path, speed, radius,
slip or covariance: a quasi-rectangle of 67 s, a G of 100 s that ends in a curve, and a longer drive
of a circle and an oscillating straight. They are made again here: ours, but for shape, duration and
noise. `python -m backhoe.drives` writes them to `data/drives/`, and with them a drive of the
machine itself in the simulation.

    scenarios   the speeds and the truth
    recording   encoders and IMU with their noise, for one run or many
    on_tracks   the machine driven in the simulation, encoders from its belts
    files       CSV in `data/drives/`, the truth apart
"""

from backhoe.drives.files import FOLDER, from_log, load, names, write
from backhoe.drives.on_tracks import drive_the_machine
from backhoe.drives.recording import NOISE, SEED, SLIPPING, Noise, Recording, record
from backhoe.drives.scenarios import RATE, SCENARIOS, Scenario, Segment, Truth, truth

__all__ = [
    "FOLDER",
    "NOISE",
    "RATE",
    "SCENARIOS",
    "SEED",
    "SLIPPING",
    "Noise",
    "Recording",
    "Scenario",
    "Segment",
    "Truth",
    "drive_the_machine",
    "from_log",
    "load",
    "names",
    "record",
    "truth",
    "write",
]

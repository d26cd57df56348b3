"""Drives with a known truth: what encoders and IMU gave, and where the machine really was.

Source: Mastalli 2013, section 4.6 drives three scenarios of which it prints no path, speed, radius,
slip or covariance: a quasi-rectangle of 67 s, a G of 100 s that ends in a curve, and a longer drive
of a circle and an oscillating straight. They are made again here: ours, but for shape, duration and
noise. `python -m backhoe.mission.write_drives` writes them to `data/drives/`, and
with them a drive of the machine itself in the simulation (`mission.drive_the_machine`).

    scenarios   the speeds and the truth
    recording   encoders and IMU with their noise, for one run or many
    files       CSV in `data/drives/`, the truth apart
"""

from backhoe.localisation.drives.files import FOLDER, from_log, load, names, save
from backhoe.localisation.drives.recording import NOISE, SEED, SLIPPING, Noise, Recording, record
from backhoe.localisation.drives.scenarios import (
    SAMPLE_RATE,
    SCENARIOS,
    Scenario,
    Segment,
    Truth,
    truth,
)

__all__ = [
    "FOLDER",
    "NOISE",
    "SAMPLE_RATE",
    "SCENARIOS",
    "SEED",
    "SLIPPING",
    "Noise",
    "Recording",
    "Scenario",
    "Segment",
    "Truth",
    "from_log",
    "load",
    "names",
    "record",
    "save",
    "truth",
]

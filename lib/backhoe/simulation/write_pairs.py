"""`python -m backhoe.simulation.write_pairs` writes stereo pairs with their truth.

`data/stereo/loading.npz` shows the loading scene: truck, heap and bucket from the house's front.
It holds `left` and `right`, uint8 (rows, columns), rectified; `disparity`, the left picture's true
one [pixels / 256], uint16, 0 for the sky; `surface`, uint8, an index of `names`; `focal` [pixels]
and `baseline` [m].
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backhoe import simulation
from backhoe.arm.kinematics import inverse_kinematics
from backhoe.perception.camera import Pinhole
from backhoe.perception.picture import looking
from backhoe.simulation.sight import Sight

FOLDER = Path(__file__).resolve().parents[3] / "data" / "stereo"
CAMERA = Pinhole.of_view((640, 480), np.radians(60))
BASELINE = 0.40
"""Between the eyes [m]."""

EYE, TARGET = (-0.9, 1.35, 3.9), (3.8, 2.9, 0.9)
"""Where the left eye is and what it looks at [m]."""

BASE, TIP = (-2.4, 0.0, 0.0), (5.6, 0.4, 2.2, np.radians(45))
"""Pose of the machine [m, rad]; the stick's tip in its frame [m] and the bucket's angle [rad]."""

STEPS = 256
"""Of a stored disparity in a pixel."""

SKY = 255


def loading_pair() -> dict[str, NDArray]:
    """The loading scene in both eyes, with the truth: arrays by name, as the file holds them."""
    eyes = [looking(EYE, TARGET) for _ in range(2)]
    eyes[1][:3, 3] += BASELINE * eyes[1][:3, 0]
    with simulation.open_world(backend="analytic") as world:
        world.reset(q=tuple(inverse_kinematics(TIP)), pose=BASE)
        sight = Sight(world)
        left, right = (sight.look(CAMERA, T) for T in eyes)
        names = np.array(sight.names)
    focal = CAMERA.K[0, 0]
    disparity = np.nan_to_num(focal * BASELINE / left.depth)
    return {
        "left": left.grey,
        "right": right.grey,
        "disparity": np.uint16(np.rint(STEPS * disparity)),
        "surface": np.where(left.surface < 0, SKY, left.surface).astype(np.uint8),
        "names": names,
        "focal": np.array(focal),
        "baseline": np.array(BASELINE),
    }


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the pairs; 0 when it is done.

    Args:
        arguments: what follows the command; the process's own if None.
    """
    parser = argparse.ArgumentParser(
        prog="python -m backhoe.simulation.write_pairs", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--folder", default=FOLDER, type=Path, help="where to (default: stereo)")
    folder = parser.parse_args(arguments).folder
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "loading.npz"
    np.savez_compressed(path, **loading_pair())
    print(path.name)
    return 0


if __name__ == "__main__":
    sys.exit(main())

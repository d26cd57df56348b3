"""Exercise 6.7: gauge and ratio of the radii from squares driven both ways round."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.localisation import odometry


def calibrate(cw: NDArray, ccw: NDArray, side: float, gauge: float) -> tuple[float, float]:
    """Real gauge [m] and right over left radius, from end places (n, 2) of squares [m]."""
    x_cw, x_ccw = cw[:, 0].mean(), ccw[:, 0].mean()
    alpha = (x_cw + x_ccw) / (-4 * side)
    beta = (x_cw - x_ccw) / (-4 * side)
    bend = side / 2 / np.sin(beta / 2)
    ratio = (bend + gauge / 2) / (bend - gauge / 2)
    return gauge * (np.pi / 2) / (np.pi / 2 - alpha), ratio


def _squares(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(15):
        gauge, side = rng.uniform(0.3, 2.5), rng.uniform(3, 6)
        ratio = 1 + rng.uniform(0.002, 0.02) * rng.choice([-1, 1])
        true = odometry.Wheels(
            2 / (1 + ratio), 2 * ratio / (1 + ratio), gauge * rng.uniform(0.96, 1.04)
        )
        ends = [
            odometry.square(true, odometry.Wheels(1.0, 1.0, gauge), side, way, runs=5)[:, :2]
            + rng.normal(0, 0.01, (5, 2))
            for way in ("cw", "ccw")
        ]
        cases.append((*ends, float(side), float(gauge)))
    return cases


def right_calibration(
    answer: tuple,
    reference: tuple,
    cw: NDArray,
    ccw: NDArray,
    side: float,
    gauge: float,
) -> bool | str:
    """x alone or x and y, the bend's radius with the drawn gauge or with the real one."""
    if np.shape(answer) != (2,):
        return "two numbers are asked: the real gauge, and the right over the left radius"
    both = [
        (cw + cw[:, ::-1]) / 2,
        (ccw - ccw[:, ::-1]) / 2,
    ]
    right = []
    for ends in ((cw, ccw), both):
        found, _ = calibrate(*ends, side, gauge)
        right += [(found, calibrate(*ends, side, lever)[1]) for lever in (gauge, found)]
        beta = (ends[1][:, 0].mean() - ends[0][:, 0].mean()) / (4 * side)
        right.append((found, 1 + beta * gauge / side))
    return any(np.allclose(answer, one, rtol=1e-6) for one in right)


def _angles(
    cw: NDArray, ccw: NDArray, side: float, gauge: float, alpha: float, beta: float
) -> tuple[float, float]:
    """The calibration with alpha and beta scaled, as mistakes scale them."""
    x_cw, x_ccw = cw[:, 0].mean(), ccw[:, 0].mean()
    turned = alpha * (x_ccw + x_cw) / (4 * side)
    bend = side / (beta * (x_ccw - x_cw) / (4 * side))
    ratio = (bend + gauge / 2) / (bend - gauge / 2)
    return gauge * (np.pi / 2) / (np.pi / 2 + turned), ratio


def _exchanged(cw: NDArray, ccw: NDArray, side: float, gauge: float) -> tuple[float, float]:
    """Sum and difference exchanged."""
    mirrored = -cw
    return calibrate(mirrored, ccw, side, gauge)


def _gauge_upside_down(cw: NDArray, ccw: NDArray, side: float, gauge: float) -> tuple:
    found, ratio = calibrate(cw, ccw, side, gauge)
    return gauge**2 / found, ratio


def _one_way(cw: NDArray, ccw: NDArray, side: float, gauge: float) -> tuple[float, float]:
    with np.errstate(all="ignore"):
        alpha = ccw[:, 0].mean() / (2 * side)
    return gauge * (np.pi / 2) / (np.pi / 2 + alpha), 1.0


SQUARES = Exercise(
    number="6.7",
    title="Calibrate from squares",
    reference=calibrate,
    cases=_squares,
    compare=right_calibration,
    mistakes={
        "sum and difference are exchanged: corners shift both x alike, bends shift them apart": (
            _exchanged
        ),
        "the gauge goes the wrong way: who turns too little has a larger gauge than drawn": (
            _gauge_upside_down
        ),
        "the ratio is left over right: a bend to the left needs the larger wheel on the right": (
            lambda cw, ccw, side, gauge: (
                calibrate(cw, ccw, side, gauge)[0],
                1 / calibrate(cw, ccw, side, gauge)[1],
            )
        ),
        "alpha and beta come out half as large: x is -2 L (alpha +- beta), cw and ccw": (
            lambda cw, ccw, side, gauge: _angles(cw, ccw, side, gauge, 0.5, 0.5)
        ),
        "alpha and beta come out twice as large: sum and difference need a half, too": (
            lambda cw, ccw, side, gauge: _angles(cw, ccw, side, gauge, 2.0, 2.0)
        ),
        "alpha and beta are in degrees and then used as radians: the quarter turn is pi / 2": (
            lambda cw, ccw, side, gauge: _angles(cw, ccw, side, gauge, 180 / np.pi, 180 / np.pi)
        ),
        "one direction alone cannot tell the two errors apart: use cw and ccw": _one_way,
        "the wheels run half a gauge inside and outside of the bend, not a whole one": (
            lambda cw, ccw, side, gauge: (
                calibrate(cw, ccw, side, gauge)[0],
                calibrate(cw, ccw, side, 2 * gauge)[1],
            )
        ),
        "the two numbers are in the reverse order: the gauge first, then the ratio": (
            lambda *given: calibrate(*given)[::-1]
        ),
        "that is the factor of the gauge: return the gauge itself, in metres": (
            lambda cw, ccw, side, gauge: (
                calibrate(cw, ccw, side, gauge)[0] / gauge,
                calibrate(cw, ccw, side, gauge)[1],
            )
        ),
    },
    hints=(
        "alpha = -(x_cw + x_ccw) / (4 L), beta = -(x_cw - x_ccw) / (4 L), with the mean x of each.",
        "gauge pi/2 / (pi/2 - alpha); R = L/2 / sin(beta/2), ratio (R + gauge/2) / (R - gauge/2).",
    ),
    tested_on="15 robots that drove five squares each way, with a scatter of 1 cm",
)

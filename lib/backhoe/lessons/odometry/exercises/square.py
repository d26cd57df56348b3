"""Exercise 6.7: gauge and ratio of the radii from squares driven both ways round."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backhoe.lessons.exercise import Exercise
from backhoe.localisation.odometry import Wheels, square


def calibrate(cw: NDArray, ccw: NDArray, side: float, gauge: float) -> tuple[float, float]:
    """Real gauge [m] and right over left radius, from end places (n, 2) of squares [m]."""
    x_cw, x_ccw = cw[:, 0].mean(), ccw[:, 0].mean()
    alpha = (x_cw + x_ccw) / (-4 * side)
    beta = (x_cw - x_ccw) / (-4 * side)
    return gauge * (np.pi / 2) / (np.pi / 2 - alpha), _ratio(beta, side, gauge)


def _ratio(beta: float, side: float, gauge: float) -> float:
    """Right over left radius of a robot that bends a side by beta [rad]."""
    bend = side / 2 / np.sin(beta / 2)
    return (bend + gauge / 2) / (bend - gauge / 2)


def _alpha(cw: NDArray, ccw: NDArray, side: float) -> float:
    return (cw[:, 0].mean() + ccw[:, 0].mean()) / (-4 * side)


def _squares(rng: np.random.Generator) -> list[tuple]:
    cases = []
    for _ in range(15):
        gauge, side = map(float, rng.uniform((0.3, 3.0), (2.5, 6.0)))
        ratio = 1 + rng.uniform(0.002, 0.02) * rng.choice([-1, 1])
        true = Wheels(2 / (1 + ratio), 2 * ratio / (1 + ratio), gauge * rng.uniform(0.96, 1.04))
        cw, ccw = (
            square(true, Wheels(1.0, 1.0, gauge), side, way)[:, :2] + rng.normal(0, 0.04, (runs, 2))
            for way, runs in zip(("cw", "ccw"), rng.integers(1, 8, 2), strict=True)
        )
        cases.append((cw, ccw, side, gauge))
    return cases


def right_calibration(
    answer: tuple, reference: tuple, cw: NDArray, ccw: NDArray, side: float, gauge: float
) -> bool | str:
    """x alone or x and y, the bend's radius with the drawn gauge or with the real one."""
    if np.shape(answer) != (2,):
        return "two numbers are asked: the real gauge, and the right over the left radius"
    right = []
    for ends in ((cw, ccw), ((cw + cw[:, ::-1]) / 2, (ccw - ccw[:, ::-1]) / 2)):
        found, ratio = calibrate(*ends, side, gauge)
        beta = (ends[1][:, 0].mean() - ends[0][:, 0].mean()) / (4 * side)
        ratios = ratio, calibrate(*ends, side, found)[1], 1 + beta * gauge / side
        right += [(found, one) for one in ratios]
    return any(np.allclose(answer, one, rtol=1e-6) for one in right)


def _scaled(cw: float, ccw: float) -> Callable[..., tuple[float, float]]:
    return lambda ends_cw, ends_ccw, *given: calibrate(cw * ends_cw, ccw * ends_ccw, *given)


def _changed(change: Callable) -> Callable[..., tuple[float, float]]:
    """`change` of the gauge found, the ratio found and the gauge drawn."""
    return lambda *given: change(*calibrate(*given), given[-1])


SQUARES = Exercise(
    number="6.7",
    title="Calibrate from squares",
    reference=calibrate,
    oracle="squares_end_there_again",
    cases=_squares,
    compare=right_calibration,
    mistakes={
        "sum and difference are exchanged: corners shift both x alike, bends shift them apart": (
            _scaled(-1, 1)
        ),
        "the gauge goes the wrong way: who turns too little has a larger gauge than drawn": (
            _changed(lambda found, ratio, gauge: (gauge**2 / found, ratio))
        ),
        "the ratio is left over right: a bend to the left needs the larger wheel on the right": (
            _changed(lambda found, ratio, gauge: (found, 1 / ratio))
        ),
        "alpha and beta come out half as large: x is -2 L (alpha +- beta), cw and ccw": (
            _scaled(0.5, 0.5)
        ),
        "alpha and beta come out twice as large: sum and difference need a half, too": (
            _scaled(2, 2)
        ),
        "alpha and beta are in degrees and then used as radians: the quarter turn is pi / 2": (
            _scaled(180 / np.pi, 180 / np.pi)
        ),
        "one direction alone cannot tell the two errors apart: use cw and ccw": (
            lambda cw, ccw, side, gauge: (gauge / (1 + ccw[:, 0].mean() / (np.pi * side)), 1.0)
        ),
        "y for x clockwise is the same, anticlockwise it has the other sign: use x, or minus y": (
            lambda cw, ccw, *given: calibrate(cw[:, ::-1], ccw[:, ::-1], *given)
        ),
        "distances from the start have lost their sign: use x": (
            lambda cw, ccw, *given: calibrate(
                *(np.hypot(*ends.T)[:, None] / np.sqrt(2) for ends in (cw, ccw)), *given
            )
        ),
        "distances from the start have no sign, and are longer by the root of 2: use x": (
            lambda cw, ccw, *given: calibrate(
                *(np.hypot(*ends.T)[:, None] for ends in (cw, ccw)), *given
            )
        ),
        "the sum of the x grows with the number of squares: use their mean": (
            lambda cw, ccw, *given: calibrate(len(cw) * cw, len(ccw) * ccw, *given)
        ),
        "the first squares alone mostly measure their bumps: use the mean of all": (
            lambda cw, ccw, *given: calibrate(cw[:1], ccw[:1], *given)
        ),
        "the mean of x and y mixes them: anticlockwise y has the other sign": (
            lambda cw, ccw, *given: calibrate(
                cw.mean(axis=1, keepdims=True), ccw.mean(axis=1, keepdims=True), *given
            )
        ),
        "alpha is in radians: a quarter turn of 90 is in degrees": (
            lambda cw, ccw, side, gauge: (
                gauge * 90 / (90 - _alpha(cw, ccw, side)),
                calibrate(cw, ccw, side, gauge)[1],
            )
        ),
        "alpha is in degrees for the gauge: then a quarter turn is 90 as well": (
            lambda cw, ccw, side, gauge: (
                gauge * np.pi / 2 / (np.pi / 2 - np.degrees(_alpha(cw, ccw, side))),
                calibrate(cw, ccw, side, gauge)[1],
            )
        ),
        "the sine is told degrees: beta is in radians": (
            lambda cw, ccw, side, gauge: (
                calibrate(cw, ccw, side, gauge)[0],
                _ratio(np.degrees((cw[:, 0].mean() - ccw[:, 0].mean()) / (-4 * side)), side, gauge),
            )
        ),
        "all signs are turned round: divide by minus 4 L": _scaled(-1, -1),
        "the wheels run half a gauge inside and outside of the bend, not a whole one": (
            lambda *given: (calibrate(*given)[0], calibrate(*given[:-1], 2 * given[-1])[1])
        ),
        "the two numbers are in the reverse order: the gauge first, then the ratio": (
            _changed(lambda found, ratio, gauge: (ratio, found))
        ),
        "that is the factor of the gauge: return the gauge itself, in metres": (
            _changed(lambda found, ratio, gauge: (found / gauge, ratio))
        ),
    },
    hints=(
        "alpha = -(x_cw + x_ccw) / (4 L), beta = -(x_cw - x_ccw) / (4 L), with the mean x of each.",
        "gauge pi/2 / (pi/2 - alpha); R = L/2 / sin(beta/2), ratio (R + gauge/2) / (R - gauge/2).",
    ),
    tested_on="15 robots that drove up to seven squares each way, with a scatter of 4 cm",
)

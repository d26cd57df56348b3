"""Systematic errors of odometry from closed squares, driven both ways round.

A differential drive that follows its own odometry round a square of side L comes back to where it
believes to have started; how far off it really is shows what it has wrong. A gauge that is wrong
turns every corner by alpha too little, in whichever direction; unequal wheels bend every side by
beta to the left. To first order the ends are off by

    clockwise      x = y = -2 L (alpha + beta)
    anticlockwise  x = -y = -2 L (alpha - beta)

so that one way round alone could not tell the two apart, and errors that cancel in it would double
in the other. A scale common to radii and gauge stays unknown: it makes the square larger, and
closed all the same.

Reference: J. Borenstein and L. Feng, "Measurement and correction of systematic odometry errors in
mobile robots", IEEE Transactions on Robotics and Automation 12 (1996) 869-880.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import (
    choice,
    generator,
    instance,
    not_negative,
    numbers,
    positive,
    whole,
)
from backhoe.localisation.odometry.dead_reckoning import integrate
from backhoe.localisation.odometry.tracked import Wheels

WAYS = ("cw", "ccw")


@dataclass(frozen=True)
class Umbmark:
    """What squares both ways round say about a differential drive.

    Attributes:
        alpha: by how much each corner is turned too little [rad], from x and y together.
        beta: by how much each side bends to the left [rad], from x and y together.
        alpha_xy, beta_xy: the same from x alone and from y alone; far apart, and something else
            than gauge and radii is wrong [rad].
        ratio: radius right over radius left, E_d [1].
        gauge_factor: true gauge over nominal gauge, E_b [1].
        wheels: corrected radii, of the same mean, and gauge [m].
        error_cw, error_ccw: distance of the mean end from the start, r_cg [m].
        error: the larger of them, E_max,syst [m].
    """

    alpha: float
    beta: float
    alpha_xy: tuple[float, float]
    beta_xy: tuple[float, float]
    ratio: float
    gauge_factor: float
    wheels: Wheels
    error_cw: float
    error_ccw: float

    @property
    def error(self) -> float:
        """The larger of both errors, the measure of Borenstein and Feng [m]."""
        return max(self.error_cw, self.error_ccw)


def square(
    true: Wheels,
    nominal: Wheels,
    side: float = 4.0,
    way: str = "ccw",
    *,
    noise: float = 0.0,
    runs: int = 1,
    rng: np.random.Generator | int | None = None,
) -> NDArray:
    """Where a vehicle really ends that drives a square by its odometry, from the origin along x.

    Args:
        true: its wheels as they are.
        nominal: its wheels as its odometry takes them to be.
        side: of the square [m].
        way: "cw" or "ccw", with corners turned on the spot.
        noise: standard deviation of what disturbs the heading on each side and in each corner, as
            bumps and slip do, unseen by the encoders [rad].
        runs: number of squares.
        rng: where the noise comes from, or a seed; needed if there is noise.

    Returns:
        True less believed pose at the end, shape (runs, 3) [m, m, rad]; the heading not wrapped.

    Raises:
        ValueError: side is not positive, an unknown way, noise without rng or negative, runs not a
            whole number above 0.
        TypeError: true or nominal is no Wheels.
    """
    instance(true, "true", Wheels), instance(nominal, "nominal", Wheels)
    side, sign = positive(side, "side", "m"), 1 if choice(way, "way", WAYS) == "ccw" else -1
    noise, runs = not_negative(noise, "noise", "rad"), whole(runs, "runs", least=1)
    corner = sign * pi / 2 * nominal.gauge / 2
    way_left, way_right = np.tile([side, -corner], 4), np.tile([side, corner], 4)
    distance, turn = true.twist(way_left / nominal.left, way_right / nominal.right)
    turns = np.tile(turn, (runs, 1))
    if noise:
        turns += noise * generator(rng).standard_normal(turns.shape)
    end = integrate(np.zeros(3), np.tile(distance, (runs, 1)), turns, 1.0)[:, -1]
    return end - [0.0, 0.0, sign * 2 * pi]


def umbmark(cw: ArrayLike, ccw: ArrayLike, side: float, nominal: Wheels) -> Umbmark:
    """Ratio of the radii and gauge from the ends of squares, by the formulas of the reference.

    They are of first order in alpha and beta; `umbmark_exact` is exact.

    Args:
        cw: true less believed position after each square clockwise, shape (n, 2), or (n, 3) with
            headings, which do not count [m]. Drive five or more: their mean is what counts.
        ccw: the same anticlockwise [m].
        side: of the square [m].
        nominal: wheels that the odometry took.

    Returns:
        What was found.

    Raises:
        ValueError: ends that are not (n, 2) or (n, 3) finite numbers, side not positive, errors so
            large that the formulas mean nothing.
    """
    side = positive(side, "side", "m")
    (x_cw, y_cw), (x_ccw, y_ccw) = _mean(cw, "cw"), _mean(ccw, "ccw")
    alpha_xy = (x_cw + x_ccw) / (-4 * side), (y_cw - y_ccw) / (-4 * side)
    beta_xy = (x_cw - x_ccw) / (-4 * side), (y_cw + y_ccw) / (-4 * side)
    alpha, beta = sum(alpha_xy) / 2, sum(beta_xy) / 2
    lever = nominal.gauge / side * sin(beta / 2)
    if abs(alpha) >= pi / 2 or abs(lever) >= 1:
        raise ValueError(
            f"the squares end {np.hypot(x_cw, y_cw):.3g} m and {np.hypot(x_ccw, y_ccw):.3g} m off "
            f"on sides of {side:.3g} m: too far for UMBmark; are the ends in metres?"
        )
    ratio, factor = (1 + lever) / (1 - lever), (pi / 2) / (pi / 2 - alpha)
    return Umbmark(
        alpha=float(alpha),
        beta=float(beta),
        alpha_xy=tuple(map(float, alpha_xy)),
        beta_xy=tuple(map(float, beta_xy)),
        ratio=float(ratio),
        gauge_factor=float(factor),
        wheels=_corrected(nominal, ratio, factor),
        error_cw=float(np.hypot(x_cw, y_cw)),
        error_ccw=float(np.hypot(x_ccw, y_ccw)),
    )


def umbmark_exact(cw: ArrayLike, ccw: ArrayLike, side: float, nominal: Wheels) -> Umbmark:
    """As `umbmark`, but without its approximations: the wheels whose squares end just there.

    Gauss-Newton on `square`, from what `umbmark` says, for ratio and gauge.

    Args, returns and errors: as for `umbmark`; ArithmeticError if it does not settle.
    """
    first = umbmark(cw, ccw, side, nominal)
    measured = np.concatenate([_mean(cw, "cw"), _mean(ccw, "ccw")])

    def ends(p: NDArray) -> NDArray:
        wheels = _corrected(nominal, *np.exp(p))
        return np.concatenate([square(wheels, nominal, side, way)[0, :2] for way in WAYS])

    p = np.log([first.ratio, first.gauge_factor])
    for _ in range(30):
        shift = 1e-6 * np.eye(2)
        jacobian = np.stack([(ends(p + s) - ends(p - s)) / 2e-6 for s in shift], axis=-1)
        change = np.linalg.lstsq(jacobian, measured - ends(p), rcond=None)[0]
        p = p + change
        if np.abs(change).max() < 1e-12:
            ratio, factor = np.exp(p)
            return replace(
                first,
                ratio=float(ratio),
                gauge_factor=float(factor),
                wheels=_corrected(nominal, ratio, factor),
            )
    raise ArithmeticError("no wheels were found whose squares end there: look at the measured ends")


def _corrected(nominal: Wheels, ratio: float, factor: float) -> Wheels:
    """Wheels of the nominal mean radius with another ratio and gauge: c_l, c_r and E_b."""
    c_left, c_right = 2 / (ratio + 1), 2 / (1 / ratio + 1)
    return Wheels(c_left * nominal.mean, c_right * nominal.mean, factor * nominal.gauge)


def _mean(ends: ArrayLike, name: str) -> NDArray:
    ends = numbers(ends, name)
    if ends.ndim != 2 or ends.shape[0] == 0 or ends.shape[1] not in (2, 3):
        raise ValueError(f"{name} must be a row x, y [m] for each square, got shape {ends.shape}")
    return ends[:, :2].mean(axis=0)

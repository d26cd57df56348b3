"""The slipping model compiled, with the integrator that suits it; in plain words it is `slipping`.

A wheel that slips a little is pulled back within J/(r^2 N mu k_s 2/pi), a millisecond and less,
while the vehicle takes tenths of a second: the model is stiff. An explicit rule would take its step
from the millisecond also where nothing happens. RODAS3 (Sandu et al. 1997) is a Rosenbrock rule of
third order, L-stable, with an error estimate in its last stage: each step solves linear equations
with the Jacobian, no iteration. Wheels touch each other only through the body, so those equations
fall to 3 by 3.

Imported on first use: Numba takes half a second to load.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan, cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from backhoe.vehicle.skid_steer.vehicle import Vehicle


class Fleet(NamedTuple):
    """Vehicles and the drives of their wheels as the compiled functions read them, a row each.

    Attributes:
        mass, inertia, radius, along, across, k_s, rolling: shape (n,); as in `Vehicle`, with the
            coefficients of friction `along` and `across` a wheel.
        x, y, load: of the contact points, shape (n, 4) [m, m, N].
        damping: torque that the drive of a wheel loses per speed, shape (n, 4) [N m s/rad].
        spin: inertia of a wheel and of what turns with it, shape (n, 4) [kg m^2].
    """

    mass: NDArray
    inertia: NDArray
    radius: NDArray
    along: NDArray
    across: NDArray
    k_s: NDArray
    rolling: NDArray
    x: NDArray
    y: NDArray
    load: NDArray
    damping: NDArray
    spin: NDArray


def fleet(
    vehicles: Sequence[Vehicle], damping: ArrayLike = 0.0, rotor_inertia: ArrayLike = 0.0
) -> Fleet:
    """The numbers of n vehicles and their drives.

    Args:
        vehicles: n of them.
        damping: as in `Fleet`, fits (n, 4) [N m s/rad].
        rotor_inertia: of what turns with each wheel, seen at the wheel, fits (n, 4) [kg m^2].
    """
    names = ("mass", "inertia", "wheel_radius", "friction_longitudinal", "friction_lateral")
    names += ("smoothing", "rolling")
    positions = np.array([p.positions for p in vehicles])
    spin = np.array([[p.wheel_inertia] for p in vehicles]) + rotor_inertia
    wheels = positions[..., 0], positions[..., 1], np.array([p.loads for p in vehicles])
    every = (np.broadcast_to(x, (len(vehicles), 4)) for x in (*wheels, damping, spin))
    scalars = (np.array([getattr(p, name) for p in vehicles]) for name in names)
    return Fleet(*scalars, *(np.array(x, float) for x in every))


# Parts of the working space: the body's inverse (3, 3), B (3, 4), C (4, 3), the wheels' diagonal
# (4), then rates, right side, new state and four stages of 10 each.
_INVERSE, _B, _C, _D, _F, _RIGHT, NEW = 0, 9, 21, 33, 37, 47, 57
_K1, _K2, _K3, _K4, ROOM = 67, 77, 87, 97, 107

_LONGEST, _SHORTEST = 5.0, 0.2
"""By how much the next step may change."""


@njit
def _grip(slip, k_s):
    """Smooth Coulomb law over the slip, and the derivative of that over the slip."""
    x = k_s * slip
    if x < 1e-4:
        return 2 / pi * k_s * (1 - x * x / 3), -4 / (3 * pi) * k_s**3
    share = 2 / pi * atan(x) / slip
    return share, (2 / pi * k_s / (1 + x * x) - share) / (slip * slip)


@njit
def _slip(y, p, n, i):
    return y[3] - y[5] * p.y[n, i] - p.radius[n] * y[6 + i], y[4] + y[5] * p.x[n, i]


@njit
def rate(y, torque, p, n, f):
    """Fill f (10,) with the rates of the state y (10,) of vehicle n: `slipping.state_rate`."""
    c, s = cos(y[2]), sin(y[2])
    f[0], f[1], f[2] = c * y[3] - s * y[4], s * y[3] + c * y[4], y[5]
    force_x, force_y, moment = 0.0, 0.0, 0.0
    for i in range(4):
        along, across = _slip(y, p, n, i)
        grip, _ = _grip(sqrt(along * along + across * across), p.k_s[n])
        fx = -p.load[n, i] * p.along[n] * grip * along
        fy = -p.load[n, i] * p.across[n] * grip * across
        force_x += fx
        force_y += fy
        moment += p.x[n, i] * fy - p.y[n, i] * fx
        lost = (p.damping[n, i] + p.load[n, i] * p.rolling[n] * p.radius[n] ** 2) * y[6 + i]
        f[6 + i] = (torque[i] - lost - p.radius[n] * fx) / p.spin[n, i]
    f[3] = force_x / p.mass[n] + y[4] * y[5]
    f[4] = force_y / p.mass[n] - y[3] * y[5]
    f[5] = moment / p.inertia[n]


@njit
def _factorise(y, diagonal, p, n, w):
    """Prepare to solve (diagonal - df/dy) k = right: the wheels eliminated, the body inverted."""
    a00, a01, a02 = diagonal, -y[5], -y[4]
    a10, a11, a12 = y[5], diagonal, y[3]
    a20, a21, a22 = 0.0, 0.0, diagonal
    for i in range(4):
        along, across = _slip(y, p, n, i)
        grip, bend = _grip(sqrt(along * along + across * across), p.k_s[n])
        gxx = -p.load[n, i] * p.along[n] * (grip + bend * along * along)
        gxy = -p.load[n, i] * p.along[n] * bend * along * across
        gyx = -p.load[n, i] * p.across[n] * bend * along * across
        gyy = -p.load[n, i] * p.across[n] * (grip + bend * across * across)
        x, z = p.x[n, i], p.y[n, i]
        # How the forces change with v_x, v_y, omega; the body feels them through 1, 1, (x, -z).
        xv, xw, xo = gxx, gxy, gxy * x - gxx * z
        yv, yw, yo = gyx, gyy, gyy * x - gyx * z
        d = (p.radius[n] ** 2 * (gxx - p.load[n, i] * p.rolling[n]) - p.damping[n, i]) / p.spin[
            n, i
        ]
        back = -p.radius[n] / p.spin[n, i]
        c0, c1, c2 = back * xv, back * xw, back * xo
        b0, b1 = -p.radius[n] * gxx / p.mass[n], -p.radius[n] * gyx / p.mass[n]
        b2 = -p.radius[n] * (x * gyx - z * gxx) / p.inertia[n]
        share = 1 / (diagonal - d)
        w[_B + i], w[_B + 4 + i], w[_B + 8 + i] = b0, b1, b2
        w[_C + 3 * i], w[_C + 3 * i + 1], w[_C + 3 * i + 2] = c0, c1, c2
        w[_D + i] = share
        a00 -= xv / p.mass[n] + b0 * c0 * share
        a01 -= xw / p.mass[n] + b0 * c1 * share
        a02 -= xo / p.mass[n] + b0 * c2 * share
        a10 -= yv / p.mass[n] + b1 * c0 * share
        a11 -= yw / p.mass[n] + b1 * c1 * share
        a12 -= yo / p.mass[n] + b1 * c2 * share
        a20 -= (x * yv - z * xv) / p.inertia[n] + b2 * c0 * share
        a21 -= (x * yw - z * xw) / p.inertia[n] + b2 * c1 * share
        a22 -= (x * yo - z * xo) / p.inertia[n] + b2 * c2 * share
    m0, m1, m2 = a11 * a22 - a12 * a21, a12 * a20 - a10 * a22, a10 * a21 - a11 * a20
    one = 1 / (a00 * m0 + a01 * m1 + a02 * m2)
    w[0], w[1], w[2] = m0 * one, (a02 * a21 - a01 * a22) * one, (a01 * a12 - a02 * a11) * one
    w[3], w[4], w[5] = m1 * one, (a00 * a22 - a02 * a20) * one, (a02 * a10 - a00 * a12) * one
    w[6], w[7], w[8] = m2 * one, (a01 * a20 - a00 * a21) * one, (a00 * a11 - a01 * a10) * one


@njit
def _solve(y, c, s, diagonal, right, w, k):
    """Solve (diagonal - df/dy) k = right with what `_factorise` left in w."""
    r0, r1, r2 = right[3], right[4], right[5]
    for i in range(4):
        spun = right[6 + i] * w[_D + i]
        r0 += w[_B + i] * spun
        r1 += w[_B + 4 + i] * spun
        r2 += w[_B + 8 + i] * spun
    k[3] = w[0] * r0 + w[1] * r1 + w[2] * r2
    k[4] = w[3] * r0 + w[4] * r1 + w[5] * r2
    k[5] = w[6] * r0 + w[7] * r1 + w[8] * r2
    for i in range(4):
        at = _C + 3 * i
        body = w[at] * k[3] + w[at + 1] * k[4] + w[at + 2] * k[5]
        k[6 + i] = (right[6 + i] + body) * w[_D + i]
    k[2] = (right[2] + k[5]) / diagonal
    k[0] = (right[0] + c * k[3] - s * k[4] - (s * y[3] + c * y[4]) * k[2]) / diagonal
    k[1] = (right[1] + s * k[3] + c * k[4] + (c * y[3] - s * y[4]) * k[2]) / diagonal


@njit
def step(y, torque, p, n, h, tolerance, w):
    """One RODAS3 step of h: the new state is left in w; returns the error over the tolerance."""
    f, right, new = w[_F:_RIGHT], w[_RIGHT:NEW], w[NEW:_K1]
    k1, k2, k3, k4 = w[_K1:_K2], w[_K2:_K3], w[_K3:_K4], w[_K4:ROOM]
    diagonal, c, s = 2 / h, cos(y[2]), sin(y[2])
    _factorise(y, diagonal, p, n, w)
    rate(y, torque, p, n, f)
    _solve(y, c, s, diagonal, f, w, k1)
    for j in range(10):
        right[j] = f[j] + 4 * k1[j] / h
    _solve(y, c, s, diagonal, right, w, k2)
    for j in range(10):
        new[j] = y[j] + 2 * k1[j]
    rate(new, torque, p, n, f)
    for j in range(10):
        right[j] = f[j] + (k1[j] - k2[j]) / h
    _solve(y, c, s, diagonal, right, w, k3)
    for j in range(10):
        new[j] += k3[j]
    rate(new, torque, p, n, f)
    for j in range(10):
        right[j] = f[j] + (k1[j] - k2[j] - 8 / 3 * k3[j]) / h
    _solve(y, c, s, diagonal, right, w, k4)
    error = 0.0
    for j in range(10):
        new[j] += k4[j]
        size = 1 + abs(new[j]) if j > 2 else 1.0
        error = max(error, abs(k4[j]) / size)
    return error / tolerance


@njit(cache=True, nogil=True)
def advance(states, torque, p, dt, h, tolerance):
    """Bring states forward by dt in place, each vehicle by steps of its own.

    Args:
        states: shape (n, 10), as in `slipping`.
        torque: torques held over dt, less what the damping takes, shape (n, 4) [N m].
        p: the vehicles, a `Fleet`.
        dt: time to go on [s].
        h: steps that the vehicles liked last, shape (n,) [s]; kept up to date.
        tolerance: error of a step in m, rad, m/s and rad/s, relative to 1 plus the value.
    """
    w = np.empty(ROOM)
    for n in range(len(states)):
        y, left = states[n], dt
        while left > 1e-12 * dt:
            length = min(h[n], left)
            error = step(y, torque[n], p, n, length, tolerance, w)
            change = 0.9 * error ** (-1 / 3) if error > 0 else _LONGEST
            if not error >= 0:
                change = _SHORTEST
            if error <= 1 or length < 1e-9:
                y[:] = w[NEW:_K1]
                left -= length
                if length < h[n]:
                    change = max(change, h[n] / length)
            h[n] = length * min(max(change, _SHORTEST), _LONGEST)

"""Friction of the tracks on the ground: what carries, drives, turns and holds the machine.

Each track rests on a row of patches. A patch's soil shears like a spring with the slip between shoe
and ground until, after `SHEAR` of slip, the friction of the patch is used up and it slides. So the
machine stands still under the push of the bucket and does not creep, and it slips when it turns. As
the belt runs, sheared soil is left behind at one end and fresh soil comes under the other.
A belt runs at a given speed (`run_belts`), or as a mass between drive, rolling resistance and
ground (`drive_belts`). The patches share the weight equally, wherever the arm is: a few patches at
the front that carry all would turn almost without slip. Whether they can carry is for `standing`.
Lengths in m, speeds in m/s, forces in N; vehicle frame (x forward, y left). `engine` has the same
functions compiled.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from backhoe.machine import Machine

PATCHES_PER_TRACK = 7

SHEAR = 0.005
"""Slip at which a patch slides [m]: our choice, stiff against the 1 cm and more of loose soil."""

RELAXATION = 0.02
"""Damping of the sheared soil as a time [s]: our choice, the machine stops rocking in one swing."""

ROLLING_SMOOTHING = 0.02
"""Belt speed below which rolling resistance passes smoothly through zero [m/s]."""

FADING = 0.1
"""Share of the belts' largest speed over which the drive fades out: our choice."""


def patch_positions(machine: Machine) -> NDArray:
    """Middle of each patch in the vehicle frame, left track first, rear to front, (14, 2) [m]."""
    tracks = machine.tracks
    x = ((np.arange(PATCHES_PER_TRACK) + 0.5) / PATCHES_PER_TRACK - 0.5) * tracks.length
    left = np.c_[x, np.full_like(x, tracks.gauge / 2)]
    return np.vstack([left, left * [1, -1]])


def run_belts(belt, belts, command, dt):
    """Let the belts' speeds (2,) follow `command` (2,) as fast as they can in dt [s], in place."""
    _, _, _, top_speed, acceleration = belt
    for side in range(2):
        wanted = min(max(command[side], -top_speed), top_speed)
        most = acceleration * dt
        belts[side] += min(max(wanted - belts[side], -most), most)


def drive_belts(belt, belts, traction, pull, weight, dt):
    """Let the belts' speeds (2,) move under the forces on them over one step, in place.

    A belt is driven at its sprocket, pushed back by the ground and held back by rolling resistance,
    which passes smoothly through zero at `ROLLING_SMOOTHING`. The drive gives at most its largest
    force, and fades out over the last `FADING` of the belt's largest speed.

    Args:
        belt: as in `forces.Numbers`.
        belts: speeds of the left and right belt, shape (2,) [m/s]; brought forward in place.
        traction: wanted driving forces, shape (2,) [N]; replaced by what the drives give.
        pull: forward force of the ground on each track, shape (2,) [N].
        weight: that presses the tracks on the ground [N]; negative counts as none.
        dt: step [s].
    """
    mass, rolling, most, top_speed, _ = belt
    resistance = rolling * max(weight, 0.0) / 2
    for side in range(2):
        speed = belts[side]
        given = min(max(traction[side], -most), most)
        if given * speed > 0.0:
            given *= min(max((1.0 - abs(speed) / top_speed) / FADING, 0.0), 1.0)
        traction[side] = given
        held = resistance * np.tanh(speed / ROLLING_SMOOTHING)
        belts[side] += dt / mass * (given - held - pull[side])


def shear(numbers, weight, twist, belts, sheared, dt):
    """Force and yaw moment of the ground on the tracks, over one step, and its part on each belt.

    Args:
        numbers: a `forces.Numbers`, of which `patches` and `friction` count.
        weight: that presses the tracks on the ground [N]; negative counts as none.
        twist: velocity of the vehicle's origin along x and y of its own frame [m/s], yaw rate
            [rad/s].
        belts: speeds of the left and right belt [m/s].
        sheared: shear of each patch in units of `SHEAR`, shape (n, 2); brought forward in place.
        dt: step [s].

    Returns:
        Force along x and y [N] and moment about z [N m], in the vehicle frame; forward force on the
        left and right track, shape (2,) [N].
    """
    patches, (along, across) = numbers.patches, numbers.friction
    n = len(patches)
    row = n // 2
    load = max(weight, 0.0) / n
    force_x, force_y, moment, pull = 0.0, 0.0, 0.0, np.zeros(2)
    for side in range(2):
        move_on(sheared, side * row, row, belts[side] * dt / (patches[1, 0] - patches[0, 0]))
        for i in range(side * row, (side + 1) * row):
            x, y = patches[i, 0], patches[i, 1]
            slip_x = twist[0] - twist[2] * y - belts[side]
            slip_y = twist[1] + twist[2] * x
            shear_x = sheared[i, 0] + slip_x * dt / SHEAR
            shear_y = sheared[i, 1] + slip_y * dt / SHEAR
            over = max(np.sqrt(shear_x**2 + shear_y**2), 1.0)
            sheared[i, 0], sheared[i, 1] = shear_x / over, shear_y / over
            pull_x = sheared[i, 0] + slip_x * RELAXATION / SHEAR
            pull_y = sheared[i, 1] + slip_y * RELAXATION / SHEAR
            over = max(np.sqrt(pull_x**2 + pull_y**2), 1.0)
            fx = -along * load * pull_x / over
            fy = -across * load * pull_y / over
            force_x += fx
            force_y += fy
            pull[side] += fx
            moment += x * fy - y * fx
    return (force_x, force_y, moment), pull


def move_on(sheared, first, row, share):
    """Carry the shear of one track's patches on by `share` of a patch: fresh soil enters."""
    if share > 0.0:
        for i in range(first, first + row):
            ahead = i + 1 < first + row
            for axis in range(2):
                entering = sheared[i + 1, axis] if ahead else 0.0
                sheared[i, axis] += share * (entering - sheared[i, axis])
    elif share < 0.0:
        for i in range(first + row - 1, first - 1, -1):
            behind = i > first
            for axis in range(2):
                entering = sheared[i - 1, axis] if behind else 0.0
                sheared[i, axis] -= share * (entering - sheared[i, axis])

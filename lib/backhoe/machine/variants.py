"""Machines made from a machine: loaded, built in another size, or with other angle offsets."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from backhoe.basics.inputs import not_negative, numbers, positive
from backhoe.machine import BACKHOE, Machine, replace


def loaded(load: float, machine: Machine = BACKHOE) -> Machine:
    """The machine with a point mass at the bucket's centre of mass.

    Args:
        load: mass in the bucket [kg], not negative.
        machine: the empty machine.

    Raises:
        ValueError: load is negative or not finite.
    """
    mass = machine.bucket.mass + not_negative(load, "load", "kg")
    return replace(machine, bucket=replace(machine.bucket, mass=mass))


def reading(offsets_deg: ArrayLike, machine: Machine = BACKHOE) -> Machine:
    """The machine in another reading of Table A.1: other offsets of stick and bucket.

    Args:
        offsets_deg: where stick, the stick's centre of mass, bucket and the bucket's centre of mass
            point at q = 0, each counted from the link before, shape (4,) [deg].
        machine: the machine with all its other numbers.

    Raises:
        ValueError: not four finite angles.
    """
    offsets = numbers(offsets_deg, "offsets_deg", (4,), meaning="angles [deg]")
    stick, stick_com, bucket, bucket_com = np.radians(offsets).tolist()
    return replace(
        machine,
        stick=replace(machine.stick, angle_offset=stick, com_angle=stick_com),
        bucket=replace(machine.bucket, angle_offset=bucket, com_angle=bucket_com),
    )


def scaled(factor: float, machine: Machine = BACKHOE) -> Machine:
    """The arm with every length `factor` times as long, and the same masses.

    Inertias grow with the square of the factor; tracks, shell and joints stay as they are.

    Args:
        factor: new length over old length, positive.
        machine: the machine of factor 1.

    Raises:
        ValueError: factor is not positive and finite.
    """
    factor = positive(factor, "factor")
    base, swing = machine.base, machine.swing
    links = {
        name: replace(
            link,
            length=factor * link.length,
            com_radius=factor * link.com_radius,
            inertia=factor**2 * link.inertia,
        )
        for name, link in zip(("boom", "stick", "bucket"), machine.links, strict=True)
    }
    return replace(
        machine,
        base=replace(base, height=factor * base.height, offset=factor * base.offset),
        swing=replace(
            swing,
            height=factor * swing.height,
            offset=factor * swing.offset,
            com_radius=factor * swing.com_radius,
            com_height=factor * swing.com_height,
            inertia=factor**2 * swing.inertia,
        ),
        **links,
    )

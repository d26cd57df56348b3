"""The force of the soil on the bucket, between two looks at the soil.

Four parts: the wedge ahead of the bucket (`earthmoving`), the same for a sideways push, the teeth's
own bearing, and the ground that carries the shell. The first three oppose motion and grow
smoothly with speed from nothing; the last is a spring that yields, and remembers its load.
"""

from __future__ import annotations

from math import atan2, copysign, cos, hypot, pi, sin, sqrt
from typing import NamedTuple

from backhoe.basics.angles import wrap
from backhoe.machine import Machine
from backhoe.simulation.soil.bucket_pose import BucketPose
from backhoe.simulation.soil.earthmoving import SoilParameters, bearing_capacity
from backhoe.simulation.soil.terrain import Contact

EDGE = 0.04
"""Thickness of the teeth [m]."""
CREEP = 0.15
"""Speed at which a resistance has reached 70 % of its full value [m/s], if `hold` allows."""
CREEPING = 0.02
"""Below this speed along the heading [m/s] the soil on the mouth's side counts as ahead."""
LIGHTER = 0.85
"""The tip feels lighter by this factor than the bucket turning alone: the other joints give way."""


class Resistance(NamedTuple):
    """Strength of the soil around the bucket at one moment.

    Attributes:
        cutting, sideways, teeth: the most that each resistance comes to [N].
        creep: speed at which they have reached 70 % of that [m/s].
        load: force of the ground under the shell [N], at most `bearing` [N].
        stiffness, damping: of that ground [N/m, N s/m].
        lever: where it acts, along the heading from the tip [m].
        pitch_rate: of the bucket [rad/s].
        at: the bucket's pose.
    """

    at: BucketPose
    cutting: float = 0.0
    sideways: float = 0.0
    teeth: float = 0.0
    creep: float = CREEP
    load: float = 0.0
    bearing: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    lever: float = 0.0
    pitch_rate: float = 0.0

    def wrench(
        self, z: float, velocity: tuple[float, float, float]
    ) -> tuple[float, float, float, float]:
        """Force in the world (x, y, z) [N] at the tip, and moment that raises the pitch [N m].

        Args:
            z: height of the tip now [m].
            velocity: of the tip now, in the world [m/s].
        """
        vx, vy, vz = velocity
        along, across = self.at.components(vx, vy)
        f_along = f_up = f_across = moment = 0.0
        if self.cutting > 0.0:
            lifting = max(vz, 0.0)
            drag = self.cutting / sqrt(along**2 + lifting**2 + self.creep**2)
            f_along, f_up = -drag * along, -drag * lifting
            f_across = -self.sideways * across / sqrt(across**2 + self.creep**2)
            c, s = cos(self.at.pitch), sin(self.at.pitch)
            tooth_first = max(along * c + vz * s, 0.0)
            teeth = self.teeth * tooth_first / sqrt(tooth_first**2 + self.creep**2)
            f_along, f_up = f_along - teeth * c, f_up - teeth * s
        if self.bearing > 0.0:
            rising = vz + self.pitch_rate * self.lever
            carried = self.load + self.stiffness * (self.at.tip[2] - z) - self.damping * rising
            carried = min(max(carried, 0.0), self.bearing)
            f_up, moment = f_up + carried, carried * self.lever
        ex, ey = self.at.heading
        return f_along * ex + f_across * ey, f_along * ey - f_across * ex, f_up, moment


class SoilForce:
    """Finds the resistance for a machine in a soil.

    A force that is held for `hold` [s] must not throw the bucket about: what it changes in the
    tip's speed, with the least effective mass of the tip, stays below the speed that caused it.
    """

    def __init__(self, soil: SoilParameters, machine: Machine, hold: float) -> None:
        self.soil, self.gravity, self.hold = soil, machine.gravity, hold
        shell, bucket = machine.shell, machine.bucket
        teeth, lip = shell.profile[0], shell.profile[-1]
        self.width = shell.width
        self.mouth = hypot(lip[0] - teeth[0], lip[1] - teeth[1])
        self.floor_angle = atan2(shell.profile[1][1] - teeth[1], shell.profile[1][0] - teeth[0])
        inertia = bucket.inertia + bucket.mass * bucket.com_radius**2
        self.mass = LIGHTER * inertia / bucket.length**2
        sole = self.width * self.mouth / 2
        self.stiffness = min(soil.subgrade, self.mass / (4 * hold**2 * sole))
        self.damping = 0.3 * self.mass / (hold * sole)
        self.strength = bearing_capacity(0.0, soil, self.gravity)
        self.sinkage = self.strength / self.stiffness

    def resistance(
        self,
        now: BucketPose,
        velocity: tuple[float, float, float],
        contact: Contact,
        depth: float,
        volume: float,
        pitch_rate: float,
        before: Resistance | None,
    ) -> Resistance:
        """Look at the soil.

        Args:
            now: where the bucket is.
            velocity: of the tip in the world [m/s].
            contact: of the shell with the ground.
            depth: of the teeth under the surface ahead [m].
            volume: in the bucket [m^3].
            pitch_rate: of the bucket [rad/s].
            before: the resistance at the last look.
        """
        cutting = sideways = teeth = 0.0
        if depth > 0.0:
            side = self.ahead(now, velocity)
            face = wrap(now.pitch + self.floor_angle)
            full = self.soil.density * self.gravity * volume / (self.width * self.mouth)
            cutting = self.soil.cutting_force(
                depth,
                face if side < 0 else pi - face,
                self.width,
                full if side == now.mouth_side else 0.0,
                self.gravity,
            )
            sideways = self.soil.cutting_force(depth, pi / 2, self.mouth, 0.0, self.gravity)
            teeth = EDGE * self.width * bearing_capacity(depth, self.soil, self.gravity)
        softest = (max(cutting, sideways) + teeth) * self.hold / self.mass
        stiffness = self.stiffness * contact.area
        load = 0.0
        if before is not None:
            fall = before.at.tip[2] - now.tip[2]
            fall -= wrap(now.pitch - before.at.pitch) * contact.lever
            load = min(max(before.load + stiffness * fall, 0.0), stiffness * contact.sunk)
        return Resistance(
            now,
            cutting,
            sideways,
            teeth,
            max(CREEP, softest),
            load,
            self.strength * contact.area,
            stiffness,
            self.damping * contact.area,
            contact.lever,
            pitch_rate,
        )

    def ahead(self, now: BucketPose, velocity: tuple[float, float, float]) -> float:
        """+1 or -1: the side along the heading where the bucket meets the soil."""
        along, _ = now.components(velocity[0], velocity[1])
        return now.mouth_side if abs(along) < CREEPING else copysign(1.0, along)

"""The force of the soil on the bucket, between two looks at the soil.

Four parts. The wedge ahead of the bucket's face (`earthmoving.cut`), with its direction and its
place: the face presses as far as it moves into the soil, the soil rubs along it the way it slides.
The same for a sideways push of a side wall. The tips of the teeth, along their own axis. And the
ground that carries the shell. The first three oppose motion and grow smoothly with speed from
nothing, so they never give the bucket power; the last is a spring that yields, and remembers its
load.
"""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin, sqrt
from typing import NamedTuple

from backhoe.basics.angles import wrap
from backhoe.machine import Machine
from backhoe.simulation.soil.bucket_pose import BucketPose
from backhoe.simulation.soil.earthmoving import NO_CUT, bearing_capacity, cut
from backhoe.simulation.soil.soils import SoilParameters
from backhoe.simulation.soil.terrain import Contact

TEETH, TOOTH_WIDTH, TOOTH_THICKNESS = 5, 0.09, 0.04
"""How many teeth, as drawn, each how wide and thick [m]: between them the lip is a plate thick."""
CREEP = 0.15
"""Speed at which a resistance has reached 70 % of its full value [m/s], if `hold` allows."""
CREEPING = 0.02
"""Until its face draws back faster than this [m/s] the soil on the mouth's side counts as ahead."""
LIGHTER = 0.85
"""The tip feels lighter by this factor than the bucket turning alone: the other joints give way."""


class Resistance(NamedTuple):
    """Strength of the soil around the bucket at one moment.

    Directions are (along the heading, up).

    Attributes:
        at: the bucket's pose.
        normal: of the face, into the soil (unit vector).
        cutting, rubbing: the most that the wedge comes to along that normal, and along the face
            [N].
        lever: of the first about the tip, positive where it raises the pitch [m].
        rise: as in `earthmoving.Cut`.
        yielding: speed along the normal at which `cutting` has reached 70 % [m/s].
        sideways, lifting: the most of a side wall's wedge, across and upwards [N].
        climb: how fast soil rises along a side wall, over the wall's speed across [1].
        shifting: speed at which those two have reached 70 % [m/s].
        tooth: where the teeth point (unit vector).
        teeth: the most that their tips bear [N].
        creep: speed at which `rubbing` and `teeth` have reached 70 % [m/s].
        load: force of the ground under the shell [N], at most `bearing` [N].
        stiffness, damping: of that ground [N/m, N s/m].
        stand: where it acts, along the heading from the tip [m].
        pitch_rate: of the bucket [rad/s].
    """

    at: BucketPose
    normal: tuple[float, float] = (1.0, 0.0)
    cutting: float = 0.0
    rubbing: float = 0.0
    lever: float = 0.0
    rise: float = 0.0
    yielding: float = CREEP
    sideways: float = 0.0
    lifting: float = 0.0
    climb: float = 0.0
    shifting: float = CREEP
    tooth: tuple[float, float] = (1.0, 0.0)
    teeth: float = 0.0
    creep: float = CREEP
    load: float = 0.0
    bearing: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    stand: float = 0.0
    pitch_rate: float = 0.0

    def wrench(
        self, z: float, velocity: tuple[float, float, float], pitch_rate: float
    ) -> tuple[float, float, float, float]:
        """Force in the world (x, y, z) [N] at the tip, and moment that raises the pitch [N m].

        Args:
            z: height of the tip now [m].
            velocity: of the tip now, in the world [m/s].
            pitch_rate: of the bucket now [rad/s].
        """
        vx, vy, vz = velocity
        ex, ey = self.at.heading
        along, across = vx * ex + vy * ey, vx * ey - vy * ex
        f_along = f_up = f_across = moment = 0.0
        if self.cutting > 0.0:
            nu, nz = self.normal
            into = along * nu + vz * nz - self.lever * pitch_rate
            if into > 0.0:
                tu, tz = (nz, -nu) if nu > 0.0 else (-nz, nu)  # down along the face
                press = into / sqrt(into * into + self.yielding**2)
                slide = along * tu + vz * tz + self.rise * into
                rub = press * self.rubbing * slide / sqrt(slide * slide + self.creep**2)
                press *= self.cutting
                f_along, f_up = -press * nu - rub * tu, -press * nz - rub * tz
                moment = press * self.lever
            if across != 0.0:
                aside = abs(across)
                press = aside / sqrt(aside * aside + self.shifting**2)
                slide = self.climb * aside - vz
                f_up += press * self.lifting * slide / sqrt(slide * slide + self.shifting**2)
                f_across = -self.sideways * (press if across > 0.0 else -press)
            tu, tz = self.tooth
            first = along * tu + vz * tz
            if first > 0.0:
                teeth = self.teeth * first / sqrt(first * first + self.creep**2)
                f_along, f_up = f_along - teeth * tu, f_up - teeth * tz
        if self.bearing > 0.0:
            rising = vz + pitch_rate * self.stand
            carried = self.load + self.stiffness * (self.at.tip[2] - z) - self.damping * rising
            carried = min(max(carried, 0.0), self.bearing)
            f_up, moment = f_up + carried, moment + carried * self.stand
        return f_along * ex + f_across * ey, f_along * ey - f_across * ex, f_up, moment


class SoilForce:
    """Finds the resistance for a machine in a soil.

    A force that is held for `hold` [s] must not throw the bucket about: what it changes in the
    tip's speed, with the least effective mass of the tip, stays below the speed that caused it.
    So at 1 ms no soil resists with more than some 190 kN for each m/s: the hardest is crept
    through.
    """

    def __init__(self, soil: SoilParameters, machine: Machine, hold: float) -> None:
        self.soil, self.gravity, self.hold = soil, machine.gravity, hold
        shell, bucket = machine.shell, machine.bucket
        teeth, lip = shell.profile[0], shell.profile[-1]
        self.width, self.plate = shell.width, shell.plate
        self.mouth = hypot(lip[0] - teeth[0], lip[1] - teeth[1])
        self.floor_angle = atan2(shell.profile[1][1] - teeth[1], shell.profile[1][0] - teeth[0])
        toothed = min(TEETH * TOOTH_WIDTH, self.width)
        self.tips = TOOTH_THICKNESS * toothed + self.plate * (self.width - toothed)
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
        side = self.ahead(now, velocity)
        face = now.pitch + self.floor_angle
        rake = wrap(face if side < 0 else pi - face)
        wedge = wall = NO_CUT
        cutting = teeth = 0.0
        if depth > 0.0:
            into_mouth = side == now.mouth_side
            full = self.soil.density * self.gravity * volume / (self.width * self.mouth)
            surcharge = full if into_mouth else 0.0
            wedge = cut(self.soil, depth, rake, self.width, surcharge, self.gravity)
            wall = cut(self.soil, depth, pi / 2, self.mouth, 0.0, self.gravity)
            cutting = wedge.normal + into_mouth * self.side_plates(depth, wedge.rake)
            teeth = self.tips * bearing_capacity(depth, self.soil, self.gravity)
        softest = (cutting + wedge.rub + teeth) * self.hold / self.mass
        softest_wall = (wall.normal + wall.rub) * self.hold / self.mass
        sine, cosine = sin(wedge.rake), cos(wedge.rake)
        stiffness = self.stiffness * contact.area
        load = 0.0
        if before is not None:
            fall = before.at.tip[2] - now.tip[2]
            fall -= wrap(now.pitch - before.at.pitch) * contact.lever
            load = min(max(before.load + stiffness * fall, 0.0), stiffness * contact.sunk)
        return Resistance(
            now,
            (side * sine, cosine),
            cutting,
            wedge.rub,
            side * min(wedge.centre, self.mouth / 2),
            wedge.rise,
            max(CREEP * sine, softest),
            wall.normal,
            wall.rub,
            wall.rise,
            max(CREEP, softest_wall),
            (-cos(face), -sin(face)),
            teeth,
            max(CREEP, softest),
            load,
            self.strength * contact.area,
            stiffness,
            self.damping * contact.area,
            contact.lever,
            pitch_rate,
        )

    def side_plates(self, depth: float, rake: float) -> float:
        """What the edges of the two side plates bear, from the teeth up to the surface [N]."""
        edges = 2 * self.plate * depth / sin(rake)
        return edges * bearing_capacity(depth / 2, self.soil, self.gravity)

    def ahead(self, now: BucketPose, velocity: tuple[float, float, float]) -> float:
        """+1 or -1: the side along the heading where the bucket's face meets the soil."""
        along, _ = now.components(velocity[0], velocity[1])
        face = now.pitch + self.floor_angle
        into_mouth = velocity[2] * cos(face) - along * sin(face)
        return now.mouth_side if into_mouth > -CREEPING else -now.mouth_side

"""Where each number of the machine comes from: its symbol, its unit and its source.

A number without a row here fails the tests, so none can enter the machine without a source.
"""

from __future__ import annotations

from dataclasses import fields, is_dataclass

from backhoe.machine import BACKHOE, JOINTS, Machine

_TABLE_A2 = "Mastalli 2013, Table A.2"
_HANG = "Mastalli 2013, Table A.2, with the sign under which the stick hangs at zero (lesson 02)"
_LIMIT = "ours: usual for a 20 to 22 t excavator, and wider than the movements of the thesis"
_FORCE = (
    "ours: the same in every posture, as no cylinder's is; `digging` sets what the teeth get of it "
    "beside makers' figures, which are for the best posture"
)
_SWING_FORCE = (
    "ours: 8 % above the Caterpillar 320, so that the movement of the thesis, 59.53 deg/s with a "
    "full bucket, leaves a fifth in reserve"
)
_FRICTION = "ours: the thesis gives no friction; a few per cent of the torque limit"
_TRACK = "ours: the thesis gives no tracks; those of a 20 to 22 t excavator (`PUBLIC_MACHINES`)"
_STANDS = (
    "ours: with it the machine carries a full bucket through its missions with less than 75 % of "
    "the load that tips it, the rule of ISO 10567; 21.5 t in all, as `PUBLIC_MACHINES`"
)
_ISOTROPIC = _TABLE_A2 + ", taken as the same about every axis (our choice)"

PUBLIC_MACHINES = {
    "Caterpillar 320": {"mass": 22000, "gauge": 2.38, "length": 3.65, "shoe": 0.6, "pull": 205e3},
    "Hyundai R210LC-7": {"mass": 21700, "gauge": 2.39, "length": 3.65, "shoe": 0.6},
    "Hyundai HX220L": {"gauge": 2.39, "length": 3.65, "shoe": 0.8, "pull": 198e3},
}
"""What makers print of machines of this class: operating mass [kg], track gauge, distance from
idler to sprocket, shoe width [m], drawbar pull [N]. Data sheets of the 320 (2017), the R210LC-7 and
the HX220L, this one on its undercarriage for long reach."""

DIGGING_MACHINES = {
    "Caterpillar 320": (22600, 1.19, 140.5e3, 106.7e3, 74e3),
    "Caterpillar 320D3": (20800, 1.00, None, None, 62e3),
    "Caterpillar 315L": (15000, None, 106.8e3, None, None),
    "Doosan DX235LCR": (24300, 0.92, 149.1e3, 105.9e3, None),
    "Hyundai HX220L, long reach": (24820, 0.52, 83.4e3, 50.0e3, None),
}
"""Operating mass [kg], heaped bucket [m^3], largest force at the bucket by its cylinder and by the
stick's (ISO 6015) [N], largest swing torque [N m]; None where the source does not say."""

DIGGING_SOURCES = {
    "Caterpillar 320": (
        "stowerscat.com/new-equipment/machines/medium-excavators/cat-320-hydraulic-excavator; "
        "swing: vdocuments.mx/technical-specifications-for-320-hydraulic-320-hydraulic-"
        "excavator-specifications.html"
    ),
    "Caterpillar 320D3": "scribd.com/document/469150544/CM20180816-25690-33214",
    "Caterpillar 315L": "panswork.com/thread-43357-lastpost.html",
    "Doosan DX235LCR": (
        "constructionequipment.com/earthmoving-report-doosan-dx235lcr-asks-little-working-room"
    ),
    "Hyundai HX220L, long reach": (
        "pdfkiwi.com/documents/1-12-hx220-l-long-reach-long-reach-82-m-26-11-boom-5fe03089361d3"
    ),
}
"""Addresses of those figures; pounds and yards are turned into kilograms, newtons and metres."""

_SOURCES = {
    "base.height": ("L0", "m", _TABLE_A2),
    "base.offset": ("b0", "m", _TABLE_A2),
    "swing.height": ("L1", "m", _TABLE_A2),
    "swing.offset": ("b1", "m", _TABLE_A2),
    "swing.mass": ("m_t", "kg", _TABLE_A2),
    "swing.com_radius": ("b_cm1", "m", _TABLE_A2),
    "swing.com_angle": ("theta_cm1", "rad", "ours: behind the axis, where the counterweight is"),
    "swing.com_height": (
        "",
        "m",
        "ours: counts in the balance, on slopes and in motion",
    ),
    "swing.inertia": ("I_t", "kg m^2", _ISOTROPIC),
    "boom.length": ("L2", "m", _TABLE_A2),
    "boom.angle_offset": ("theta_2", "rad", _TABLE_A2),
    "boom.mass": ("m_bo", "kg", _TABLE_A2),
    "boom.com_radius": ("L_cm2", "m", _TABLE_A2),
    "boom.com_angle": ("theta_cm2", "rad", _TABLE_A2),
    "boom.inertia": ("I_bo", "kg m^2", _ISOTROPIC),
    "stick.length": ("L3", "m", _TABLE_A2),
    "stick.angle_offset": ("-theta_3", "rad", _HANG),
    "stick.mass": ("m_s", "kg", _TABLE_A2),
    "stick.com_radius": ("L_cm3", "m", _TABLE_A2),
    "stick.com_angle": ("-theta_cm3", "rad", _HANG),
    "stick.inertia": ("I_s", "kg m^2", _ISOTROPIC),
    "bucket.length": ("L4", "m", _TABLE_A2),
    "bucket.angle_offset": ("-theta_4", "rad", _HANG),
    "bucket.mass": ("m_bu", "kg", _TABLE_A2),
    "bucket.com_radius": ("L_cm4", "m", _TABLE_A2),
    "bucket.com_angle": ("-theta_cm4", "rad", _HANG),
    "bucket.inertia": ("I_bu", "kg m^2", _ISOTROPIC),
    "tracks.gauge": ("l", "m", _TRACK),
    "tracks.length": ("", "m", _TRACK),
    "tracks.shoe_width": ("", "m", _TRACK),
    "tracks.height": ("", "m", _TRACK),
    "tracks.sprocket_radius": ("r", "m", _TRACK),
    "tracks.max_speed": ("", "m/s", _TRACK),
    "tracks.acceleration": ("", "m/s^2", _TRACK),
    "tracks.mass": ("", "kg", _STANDS),
    "tracks.friction_longitudinal": ("", "1", "ours: firm soil, Coulomb"),
    "tracks.friction_lateral": ("", "1", "ours: firm soil, Coulomb"),
    "tracks.belt_mass": ("", "kg", "ours: 1000 kg of chain and shoes, 300 kg of geared motor"),
    "tracks.rolling_resistance": ("", "1", "ours: a crawler on firm soil, running gear included"),
    "tracks.max_traction": ("", "N", "ours: half the drawbar pull of a 20 to 22 t excavator"),
    "shell.width": ("", "m", "ours: a general purpose bucket for this tip radius"),
    "shell.plate": ("", "m", "ours: a general purpose bucket for this tip radius"),
    "shell.profile": ("", "m", "ours: a curved floor between the teeth and the pin"),
    "gravity": ("g", "m/s^2", "ours: the thesis does not print it"),
}
_SOURCES |= {
    f"{link}.joint.{name}": ("", unit, source)
    for link in JOINTS
    for name, unit, source in (
        ("lower", "rad", _LIMIT),
        ("upper", "rad", _LIMIT),
        ("speed", "rad/s", _LIMIT),
        ("torque", "N m", _SWING_FORCE if link == "swing" else _FORCE),
        ("viscous", "N m s/rad", _FRICTION),
        ("coulomb", "N m", _FRICTION),
    )
}


def provenance(machine: Machine = BACKHOE) -> list[tuple[str, object, str, str, str]]:
    """Every number of the machine with its origin.

    Returns:
        Rows (name, value, symbol, unit, source) in the order of the dataclasses; name is the path,
        such as "boom.length".
    """

    def leaves(owner: object, path: str) -> list[tuple[str, object]]:
        found = []
        for field in fields(owner):
            value, name = getattr(owner, field.name), path + field.name
            found += leaves(value, name + ".") if is_dataclass(value) else [(name, value)]
        return found

    return [(name, value, *_SOURCES[name]) for name, value in leaves(machine, "")]


def digging(machine: Machine = BACKHOE) -> list[tuple]:
    """What the machine digs with, first, beside machines whose makers print it.

    The bucket's force is its joint's torque over the bucket's length, the stick's its joint's over
    stick and bucket in line, as far as the teeth get from it.

    Returns:
        Rows (name, mass [kg], heaped bucket [m^3], force by the bucket [N], by the stick [N], swing
        torque [N m]); None where a source does not say.
    """
    swing, _, stick, bucket = machine.torque_limit.tolist()
    reach = machine.stick.length + machine.bucket.length
    forces = bucket / machine.bucket.length, stick / reach, swing
    ours = ("ours", machine.mass, machine.shell.heaped_capacity, *forces)
    return [ours, *((name, *row) for name, row in DIGGING_MACHINES.items())]

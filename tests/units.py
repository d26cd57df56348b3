"""A vehicle in other units of mass, length and time, as a formula of right dimensions survives."""

from dataclasses import fields

from backhoe.vehicle.skid_steer import Vehicle

UNITS = {  # (kg, m, s) exponents
    "mass": (1, 0, 0),
    "inertia": (1, 2, 0),
    "wheel_inertia": (1, 2, 0),
    "wheel_mass": (1, 0, 0),
    "rolling": (0, -1, 1),
    "lateral": (0, -1, 1),
    "smoothing": (0, -1, 1),
    "speed_gain": (1, 2, -1),
    "gravity": (0, 1, -2),
    "friction_longitudinal": (0, 0, 0),
    "friction_lateral": (0, 0, 0),
}


def in_units(vehicle, kg, m, s):
    """The same vehicle in units of mass, length and time so many kg, m and s large."""
    scaled = {}
    for field in fields(vehicle):
        a, b, c = UNITS.get(field.name, (0, 1, 0))
        scaled[field.name] = getattr(vehicle, field.name) / (kg**a * m**b * s**c)
    return Vehicle(**scaled)

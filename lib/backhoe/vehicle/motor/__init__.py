"""A direct-current motor that drives a wheel through a gearbox, and the control of its speed.

- `parameters`: motor, gearbox and load in numbers; `WHEELCHAIR` and `ROVER`
- `model`: the equations, sampled exactly
- `wheel`: speed control of a wheel

Source: D'Angelo 2022, chapter 4, which prints no parameters but 24 V, 450 W and n = 100.
"""

from backhoe.vehicle.motor.model import Discrete, FirstOrder, discretise, first_order, torque
from backhoe.vehicle.motor.parameters import (
    ROVER,
    WHEELCHAIR,
    Load,
    Motor,
    hanging_wheel,
    replace,
    vehicle_load,
)
from backhoe.vehicle.motor.wheel import (
    WHEEL_PERIOD,
    WheelGains,
    WheelRun,
    control_wheel,
    overshoot,
    settling_time,
    tune_wheel,
    wheel_pid,
)

__all__ = [
    "ROVER",
    "WHEELCHAIR",
    "WHEEL_PERIOD",
    "Discrete",
    "FirstOrder",
    "Load",
    "Motor",
    "WheelGains",
    "WheelRun",
    "control_wheel",
    "discretise",
    "first_order",
    "hanging_wheel",
    "overshoot",
    "replace",
    "settling_time",
    "torque",
    "tune_wheel",
    "vehicle_load",
    "wheel_pid",
]

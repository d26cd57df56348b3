"""The exercises of lesson 03, Lyapunov PID: references and the mistakes that they recognise."""

from backhoe.exercises.lyapunov_pid.clock import CLOCK
from backhoe.exercises.lyapunov_pid.constants import CERTIFICATE, GRAVITY_CONSTANT
from backhoe.exercises.lyapunov_pid.digital import DIGITAL
from backhoe.exercises.lyapunov_pid.loop import ACCELERATION, FUNCTION, INTEGRAL
from backhoe.exercises.lyapunov_pid.tuned import TUNED

__all__ = ["EXERCISES"]

EXERCISES = (
    INTEGRAL,
    ACCELERATION,
    FUNCTION,
    GRAVITY_CONSTANT,
    CERTIFICATE,
    CLOCK,
    TUNED,
    DIGITAL,
)

"""The exercises of lesson 03, Lyapunov PID: references and the mistakes that they recognise."""

from backhoe.lessons.lyapunov_pid.exercises.clock import CLOCK
from backhoe.lessons.lyapunov_pid.exercises.constants import CERTIFICATE, GRAVITY_CONSTANT
from backhoe.lessons.lyapunov_pid.exercises.digital import DIGITAL, FILTERED
from backhoe.lessons.lyapunov_pid.exercises.loop import FUNCTION, INTEGRAL, RATE
from backhoe.lessons.lyapunov_pid.exercises.tuned import TUNED

__all__ = ["EXERCISES"]

EXERCISES = (
    INTEGRAL,
    RATE,
    FUNCTION,
    GRAVITY_CONSTANT,
    CERTIFICATE,
    CLOCK,
    TUNED,
    DIGITAL,
    FILTERED,
)

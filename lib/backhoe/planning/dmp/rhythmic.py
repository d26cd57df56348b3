"""A primitive that repeats: the phase turns instead of falling, the kernels lie around a circle.

tau dv/dt = K (g + r f(phi) - x) - D v with dphi/dt = 2 pi / period; the goal is now the centre of
the swing and r its size. Source: Ijspeert et al. 2003.
"""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs
from backhoe.planning.dmp import spring
from backhoe.planning.dmp.motion import motion


class Rhythmic:
    """A rhythmic primitive in any number of dimensions.

    Args:
        kernels: how many, around the circle.
        stiffness, damping, tau: K [1], D [1], critical if None, and tau [s], as for `DMP`.
        width: standard deviation of a kernel over the distance to the next.
        smoothing: half width of the window for velocities and accelerations [s]; 0: none.

    Attributes:
        centre: mean of a period, shape (d,) [unit].
        period: of the demonstration [s].
        weights: shape (kernels, d) [unit].

    Raises:
        ValueError: a number out of its bounds.
    """

    def __init__(
        self,
        kernels: int = 25,
        stiffness: float = 50_000.0,
        damping: float | None = None,
        tau: float = 6.0,
        *,
        width: float = 1.2,
        smoothing: float = 0.0,
    ) -> None:
        self.kernels = inputs.whole(kernels, "kernels", least=3, most=10_000)
        if damping is None:
            damping = 2 * inputs.positive(stiffness, "stiffness") ** 0.5
        spring_ = spring.checked(stiffness, inputs.positive(damping, "damping"), tau)
        self.stiffness, self.damping, self.tau = spring_
        self.width = inputs.positive(width, "width")
        self.smoothing = inputs.not_negative(smoothing, "smoothing", "s")

    def learn(self, positions: ArrayLike, times: ArrayLike, period: float) -> Rhythmic:
        """Learn from a demonstration of one period or more, and return the primitive itself.

        Args:
            positions: shape (m, d) [any unit].
            times: rising, shape (m,), or one step [s].
            period: of the movement [s].

        Raises:
            ValueError: as for `motion`, or less than one period shown.
        """
        shown = motion(positions, times, self.smoothing)
        period = inputs.number(period, "period", "s", least=1e-5, most=1e8)
        turns = int(shown.duration / period + 1e-6)
        if turns < 1:
            raise ValueError(
                f"positions must show a period of {period:g} s, they last {shown.duration:g} s"
            )
        self.period, self.step = period, shown.duration / (len(shown.t) - 1)
        even = np.linspace(0, turns * period, max(200, len(shown.t)), endpoint=False)
        self.centre = np.array([np.interp(even, shown.t, one).mean() for one in shown.x.T])
        scale = self.tau / self.stiffness
        u = shown.x + scale * self.tau * shown.a + scale * self.damping * shown.v
        table = self.basis(2 * pi * shown.t / period)
        square = table.T @ table / len(table) + 1e-9 * np.eye(self.kernels)
        self.weights = np.linalg.solve(square, table.T @ (u - self.centre) / len(table))
        return self

    def basis(self, angle: ArrayLike) -> NDArray:
        """The kernels exp(h (cos(angle - c_i) - 1)) over their sum, shape (m, kernels) [1].

        Args:
            angle: phases, shape (m,) [rad].
        """
        angle = inputs.numbers(angle, "angle", ("m",))
        apart = 2 * pi / self.kernels
        away = angle[:, None] - apart * np.arange(self.kernels)
        psi = np.exp((np.cos(away) - 1) / (self.width * apart) ** 2)
        return psi / psi.sum(axis=1, keepdims=True)

    def rollout(
        self,
        duration: float,
        dt: float | None = None,
        *,
        centre: ArrayLike | None = None,
        size: float = 1.0,
        period: float | None = None,
        start: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
    ) -> tuple[NDArray, NDArray, NDArray]:
        """The swing, for any time and around any centre.

        Args:
            duration: [s].
            dt: step, shortened so that whole steps fill the duration [s]; the demonstration's if
                None.
            centre: shape (d,) [unit]; that of the demonstration if None.
            size: of the swing over the demonstrated one; negative swings the other way.
            period: tau is stretched with it [s]; that of the demonstration if None.
            start: shape (d,) [unit]; if None, on the swing as it goes once it has settled.
            velocity: at the start, shape (d,) [unit/s]; at rest at a given start if None.

        Returns:
            Times (m,) [s], positions (m, d) [unit], velocities (m, d) [unit/s].

        Raises:
            ValueError: another shape, or a number out of its bounds.
            RuntimeError: not learnt yet.
        """
        if not hasattr(self, "weights"):
            raise RuntimeError("the primitive has learnt nothing yet: call learn(...)")
        d = len(self.centre)
        centre = self.centre if centre is None else inputs.numbers(centre, "centre", (d,))
        size, duration = inputs.number(size, "size"), inputs.positive(duration, "duration", "s")
        period = (
            self.period
            if period is None
            else inputs.number(period, "period", "s", least=1e-5, most=1e8)
        )
        dt = self.step if dt is None else inputs.positive(dt, "dt", "s")
        steps = spring.whole_steps(duration, dt)
        dt, tau = duration / steps, self.tau * period / self.period
        M = spring.step_matrix(dt, self.stiffness, self.damping, tau)

        def far_end(t: NDArray) -> NDArray:
            return centre + size * self.basis(2 * pi * t / period) @ self.weights

        if start is None:
            before = np.arange(-max(2, spring.whole_steps(period, dt)), 1) * dt
            x, v = spring.follow(far_end(before), centre, np.zeros(d), M)
            start, settled = x[-1], v[-1]
        else:
            start, settled = inputs.numbers(start, "start", (d,)), np.zeros(d)
        first = settled if velocity is None else inputs.numbers(velocity, "velocity", (d,))
        t = dt * np.arange(steps + 1)
        return t, *spring.follow(far_end(t), start, first, M)

"""Sample and hold: a controller that runs faster than its measurement arrives."""

from __future__ import annotations

from numpy.typing import ArrayLike, NDArray

from backhoe.basics.inputs import real_numbers, whole


class SampleHold:
    """Lets every m-th value through and repeats it in between.

    Source: Mastalli 2013, section 3.4: the loop runs at 1000 Hz, the joints' state comes at 100 Hz.

    Args:
        every: m, how many calls see the same value: 10 for a state at 100 Hz in a loop at 1 kHz.

    Raises:
        ValueError: every is not a whole number, 1 or more.
    """

    def __init__(self, every: int) -> None:
        self.every = whole(every, "every", least=1)
        self.reset()

    def reset(self) -> None:
        """Let the next value through."""
        self._calls = 0
        self._held: NDArray | None = None

    def __call__(self, value: ArrayLike) -> NDArray:
        """The value that the controller sees.

        Args:
            value: what is there now, any shape and unit.

        Returns:
            The value of this call or of up to `every` - 1 calls ago, as an array of its own.

        Raises:
            ValueError: value is not made of real numbers.
        """
        if self._calls % self.every == 0:
            self._held = real_numbers(value, "value").copy()
        self._calls += 1
        return self._held.copy()

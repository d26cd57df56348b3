"""What an exercise is: a reference, inputs to try it on, the mistakes to expect and the hints.

Lessons declare their exercises; `backhoe.course.checking` asks, compares and names the mistake, and
has an example.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from backhoe.basics.inputs import not_negative, positive

__all__ = ["Exercise", "source_of", "sources_of"]


@dataclass(frozen=True)
class Exercise:
    """One exercise, checked by `check(number, answer)`.

    Function exercises have `cases`, a function of a random generator that returns argument tuples;
    the answer is called with each and compared with `reference`. Without `cases` the answer is a
    value (number, array or text), and `reference` is that value or a function without arguments
    that computes it. Numbers agree within `atol + rtol * abs(reference)`. Where several answers are
    right, `compare(answer, reference, *arguments)` gets what both returned and says None or True
    for right, False or a one-line diagnosis for wrong. Where the reference raises, the answer must
    raise the same error. `timeout` [s] is for all cases together.

    Where the library has the function that is asked for, `reference` is that function. `oracle`
    names what proves it: a function of `tests/lessons/<lesson>/oracles.py`, which asserts on what
    the reference gave and the arguments, by another way than the reference's own.
    `mistakes` are wrong answers that students give, by the diagnosis, one line for the student: the
    reference with the mistake built in, recognised because it gives the same.

    Raises:
        ValueError: a text has no or several lines, the number is not of the form "1.2", a
            tolerance is negative, or the reference is a lambda (its source could not be shown).
    """

    number: str
    title: str
    reference: object
    cases: Callable[[np.random.Generator], Sequence[tuple]] | None = None
    mistakes: Mapping[str, object] = field(default_factory=dict)
    hints: tuple[str, ...] = ()
    rtol: float = 1e-6
    atol: float = 1e-9
    tested_on: str = ""
    compare: Callable[..., bool | str | None] | None = None
    timeout: float = 5.0
    oracle: str = ""

    def __post_init__(self) -> None:
        if not re.fullmatch(r"\d+\.\d+", self.number):
            raise ValueError(f'an exercise is numbered like "1.2", got {self.number!r}')
        for text in (self.title, *self.hints, *self.mistakes):
            _one_line(f"every text of exercise {self.number}", text)
        not_negative(self.rtol, "rtol"), not_negative(self.atol, "atol")
        positive(self.timeout, "timeout", "s")
        if getattr(self.reference, "__name__", "") == "<lambda>":
            raise ValueError(
                f"exercise {self.number}: the reference is a lambda; name it, its source is shown"
            )
        functions = (self.reference, *self.mistakes.values())
        if self.cases is not None and not all(map(callable, functions)):
            raise ValueError(
                f"exercise {self.number} has cases: its reference and mistakes must be functions"
            )

    @property
    def asks_for_a_function(self) -> bool:
        """Whether the answer is a function rather than a value."""
        return self.cases is not None

    def inputs(self) -> list[tuple]:
        """The argument tuples to try, the same at every call; one empty tuple for a value.

        Raises:
            ValueError: there are no cases.
            TypeError: a case is not a tuple of arguments.
        """
        if self.cases is None:
            return [()]
        lesson, place = self.number.split(".")
        cases = list(self.cases(np.random.default_rng([int(lesson), int(place)])))
        if not cases:
            raise ValueError(f"exercise {self.number}: no cases to try")
        for case in cases:
            if not isinstance(case, tuple):
                raise TypeError(
                    f"exercise {self.number}: a case is a tuple of arguments such as (q,), "
                    f"got {type(case).__name__}"
                )
        return cases

    def argument_names(self, count: int) -> list[str]:
        """Names of the first `count` arguments, read from the reference."""
        if not count:
            return []
        names = list(inspect.signature(source_of(self.reference)).parameters)
        return names[:count] if len(names) >= count else [f"argument {i}" for i in range(count)]


def source_of(function: object) -> object:
    """The plain Python function behind decorators, partial application and compilation."""
    while True:
        if isinstance(function, partial):
            function = function.func
        elif hasattr(function, "py_func"):
            function = function.py_func
        elif hasattr(function, "__wrapped__"):
            function = function.__wrapped__
        else:
            return function


def sources_of(function: object) -> list[object]:
    """The plain Python function and the private ones of its module that it calls, in that order."""
    found = [source_of(function)]
    for one in found:
        codes = [one.__code__]
        for code in codes:
            codes += filter(inspect.iscode, code.co_consts)
        called = [one.__globals__.get(name) for code in codes for name in code.co_names]
        found += [
            other
            for other in dict.fromkeys(filter(inspect.isfunction, called))
            if other.__name__[0] == "_"
            and other.__module__ == one.__module__
            and other not in found
        ]
    return found


def _one_line(what: str, text: str) -> None:
    if not text.strip() or len(text.splitlines()) != 1:
        raise ValueError(f"{what} must be one line of text, got {text!r}")

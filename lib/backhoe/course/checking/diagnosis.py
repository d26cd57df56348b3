"""Name the likely mistake in an answer: known mistakes first, then the usual transformations.

An answer is told what is odd about its numbers (a sign, a factor, an order, some components). It is
never told the numbers that are expected: those would turn the check into an answer book. Known
mistakes come before errors of form because a mistake may well be one of form.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dis import get_instructions
from functools import partial

import numpy as np
from numpy.typing import NDArray

from backhoe.course.checking.answers import Trial, gives
from backhoe.course.checking.outcomes import (
    Blank,
    Numbers,
    Odd,
    Raised,
    agree,
    outcome_of,
    plain,
    show,
)
from backhoe.course.checking.patterns import in_pieces, overall
from backhoe.lessons.exercise import source_of

_QUIET = (
    *("RESUME", "NOP", "CACHE", "EXTENDED_ARG", "POP_TOP", "COPY", "SWAP", "MAKE_CELL"),
    *("LOAD_", "STORE_FAST", "UNPACK_SEQUENCE", "BUILD_TUPLE", "RETURN_", "ROT_"),
)
"""Instructions of a stub, in any version of Python: names of arguments and constants."""


def is_untouched(trial: Trial) -> bool:
    """Whether the answer is the stub as it stood in the notebook."""
    return bool(trial.outcomes) and all(
        isinstance(outcome, Blank)
        or (isinstance(outcome, Raised) and outcome.kind == "NotImplementedError")
        for outcome in trial.outcomes
    )


def gives_nothing_back(answer: object, trial: Trial) -> str | None:
    """What to say of a function that returns None though it does something; None for a stub.

    A stub's body only takes its arguments apart: any other instruction is a student's.
    """
    if not all(isinstance(outcome, Blank) for outcome in trial.outcomes):
        return None
    if trial.printed:
        return (
            "it prints, but returns None: print only shows a value; give it back with return, "
            "as the last line"
        )
    function = source_of(answer)
    if not inspect.isfunction(function):
        function = type(function).__call__
    code = getattr(function, "__code__", None)
    if code is None or all(one.opname.startswith(_QUIET) for one in get_instructions(code)):
        return None
    return "it computes something, but returns None: is `return` missing, or still `return None`?"


def diagnose(trial: Trial) -> str | None:
    """One line about what is wrong with the answer; None if it is right."""
    if trial.misuse:
        return trial.misuse
    if not trial.wrong:
        return trial.changed and (
            f"the numbers are right, but the function changes its argument {trial.changed} "
            f"in place: work on a copy, {trial.changed} = np.array({trial.changed})"
        )
    with np.errstate(all="ignore"):
        known = _known_mistake(trial)
        if known:
            return known
        text = _error(trial) or _form(trial) or _remark(trial) or _what_differs(trial)
    return text + (f"; it also changes {trial.changed} in place" if trial.changed else "")


def _known_mistake(trial: Trial) -> str | None:
    if all(isinstance(outcome, Raised) for outcome in trial.outcomes):
        return None
    for diagnosis, answer in trial.exercise.mistakes.items():
        given = gives(trial.exercise, answer, trial.cases)
        wrong = list(map(outcome_of, given, trial.references))
        alike = _same(trial, _as_nan(trial.outcomes, wrong), wrong)
        if alike and not _same(trial, wrong, trial.right):
            return diagnosis
    return None


def _as_nan(outcomes: Sequence[object], wrong: Sequence[object]) -> list[object]:
    """The outcomes, with a `ValueError` for an input out of reach counted as the mistake's NaN."""
    return [
        other
        if isinstance(one, Raised)
        and one.kind == "ValueError"
        and isinstance(other, Numbers)
        and all(np.isnan(part).any() for part in other.parts)
        else one
        for one, other in zip(outcomes, wrong, strict=True)
    ]


def _same(trial: Trial, one: Sequence[object], other: Sequence[object]) -> bool:
    return all(agree(a, b, trial.exercise) for a, b in zip(one, other, strict=True))


def _error(trial: Trial) -> str | None:
    for i in trial.wrong:
        outcome, reference = trial.outcomes[i], trial.references[i]
        if isinstance(outcome, Raised) and not isinstance(reference, Exception):
            return f"it stops with {outcome.text}{_told(trial, i) if i else ''}"
    return None


def _form(trial: Trial) -> str | None:
    verb = "it returns" if trial.exercise.asks_for_a_function else "it is"
    for i in trial.wrong:
        any_shape = isinstance(trial.verdicts[i], str)
        malformed = _malformed(trial.outcomes[i], trial.references[i], any_shape)
        if malformed:
            return f"{verb} {malformed}{_told(trial, i)}"
    return None


def _remark(trial: Trial) -> str | None:
    """What the exercise's own `compare` says."""
    return next((trial.verdicts[i] for i in trial.wrong if trial.verdicts[i]), None)


def _what_differs(trial: Trial) -> str:
    wrong = trial.only(trial.wrong)
    right = len(trial.cases) - len(wrong.cases)
    share = f"right for {right} of {len(trial.cases)} inputs; for the others " if right else ""
    numeric = all(isinstance(outcome, Numbers) for outcome in trial.outcomes)
    if numeric and not trial.exercise.compare:
        return _other_inputs(trial) or share + (_transformed(wrong) or _differs(wrong))
    outcome = wrong.outcomes[0]
    what = show(outcome if isinstance(outcome, str) else outcome.value)
    if not trial.exercise.asks_for_a_function:
        return f"{what} is not it"
    return f"{share}it gives {what}{_told(wrong, 0)}"


def _told(trial: Trial, place: int) -> str:
    """The input of a case, as the end of a sentence."""
    case = trial.cases[place]
    names = trial.exercise.argument_names(len(case))
    told = ", ".join(
        f"{name} = {show(one)}" if np.size(one) <= 8 else f"{name} of shape {np.shape(one)}"
        for name, one in zip(names, case, strict=True)
        if isinstance(one, str | int | float | np.ndarray)
    )
    return f", for {told}" if 0 < len(told) <= 100 else ""


def _malformed(outcome: object, reference: object, any_shape: bool) -> str | None:
    """What is odd about the outcome's form, in words that follow "it returns"."""
    if isinstance(reference, Exception):
        what = f"stops with {outcome.text}" if isinstance(outcome, Raised) else "no error"
        return f"{what} where {type(reference).__name__} is expected"
    if isinstance(outcome, Blank):
        return "None"
    if isinstance(outcome, Odd):
        return outcome.text
    if not isinstance(outcome, Numbers):
        return None
    wanted = plain(reference, reference).parts
    for part, other in zip(outcome.parts, wanted, strict=True):
        if any_shape and np.isfinite(part).all():
            continue
        if part.shape != other.shape:
            text = f"{_described(part)} where {_described(other)} is expected"
            if part.shape == other.shape[::-1]:
                return f"{text} (transposed?)"
            return f"{text} (reshape it)" if part.size == other.size else text
        if not np.isfinite(part).all() and np.isfinite(other).all():
            return "NaN" if np.isnan(part).any() else "infinity"
    return None


def _described(array: NDArray) -> str:
    return f"an array of shape {array.shape}" if array.ndim else "a single number"


def _other_inputs(trial: Trial) -> str | None:
    """Whether the answer is right for inputs that were not asked for."""

    def each(change: Callable[[NDArray], NDArray]) -> Callable[[tuple], tuple]:
        return lambda case: tuple(
            change(np.asarray(one)) if isinstance(one, float | np.ndarray) else one for one in case
        )

    usual = {
        "it would be right for np.radians of the input: radians for degrees?": each(np.radians),
        "it would be right for np.degrees of the input: degrees for radians?": each(np.degrees),
        "it turns the sign of the input": each(np.negative),
        "it takes the arguments in the reverse order": lambda case: case[::-1],
    }
    if not trial.exercise.asks_for_a_function:
        return None

    def constant(outcomes: Sequence[object]) -> bool:
        return all(agree(one, outcomes[0], trial.exercise) for one in outcomes)

    for text, change in usual.items():
        cases = list(map(change, trial.cases))
        given = gives(trial.exercise, trial.exercise.reference, cases)
        right = list(map(outcome_of, given, given))
        if (constant(trial.right) or not constant(right)) and _same(trial, trial.outcomes, right):
            return text
    return None


def _transformed(trial: Trial) -> str | None:
    count = len(trial.right[0].parts)
    near = partial(np.isclose, rtol=trial.exercise.rtol, atol=trial.exercise.atol)
    for part in range(count):
        given = [outcome.parts[part] for outcome in trial.outcomes]
        wanted = [outcome.parts[part] for outcome in trial.right]
        if wanted[0].dtype.kind == "b":
            continue
        alike = len({array.shape for array in wanted}) == 1
        one, other = (
            np.stack(arrays) if alike else np.concatenate([array.ravel() for array in arrays])
            for arrays in (given, wanted)
        )
        if near(one, other).all():
            continue
        text = overall(one, other, near) or (in_pieces(one, other, near) if alike else None)
        if text:
            return text if count == 1 else f"value {part + 1} of {count}: {text}"
    return None


def _differs(trial: Trial) -> str:
    outcome = trial.outcomes[0]
    value, what = outcome.value, show(outcome.value)
    if not trial.exercise.asks_for_a_function and np.ndim(value) == 0:
        return f"{what} is too {'large' if value > trial.references[0] else 'small'}"
    if outcome.parts[0].dtype.kind == "b":
        return f"it gives {what}{_told(trial, 0)}"
    error = max(
        float(np.max(np.abs(part - other), initial=0.0))
        for outcome, right in zip(trial.outcomes, trial.right, strict=True)
        for part, other in zip(outcome.parts, right.parts, strict=True)
    )
    return f"it gives {what}{_told(trial, 0)}; the largest error is {error:.3g}"

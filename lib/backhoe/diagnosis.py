"""Name the likely mistake in an answer: known mistakes first, then the usual transformations.

An answer is told what is odd about its numbers (a sign, a factor, an order, some components). It is
never told the numbers that are expected: those would turn the check into an answer book.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray

from backhoe.answers import Asked, Blank, Numbers, Odd, Raised, agree, plain, show
from backhoe.exercise import Exercise

__all__ = ["diagnose", "expected", "is_untouched"]

_FACTORS = {
    "2": 2.0,
    "3": 3.0,
    "4": 4.0,
    "pi": pi,
    "2 pi": 2 * pi,
    "180/pi (degrees where radians are expected?)": 180 / pi,
    "1000": 1000.0,
    "100": 100.0,
    "60": 60.0,
    "3.6": 3.6,
    "9.81": 9.81,
    "the root of 2": 2**0.5,
    "1e6": 1e6,
    "1/2": 1 / 2,
    "1/3": 1 / 3,
    "1/4": 1 / 4,
    "1/pi": 1 / pi,
    "1/(2 pi)": 1 / (2 * pi),
    "pi/180 (radians where degrees are expected?)": pi / 180,
    "1/1000": 1e-3,
    "1/100": 1e-2,
    "1/60": 1 / 60,
    "1/3.6": 1 / 3.6,
    "1/9.81": 1 / 9.81,
    "1/root of 2": 0.5**0.5,
    "1e-6": 1e-6,
}
_OFFSETS = {"pi/2": pi / 2, "pi": pi, "2 pi": 2 * pi, "90": 90.0, "180": 180.0, "360": 360.0}


def expected(exercise: Exercise, cases: Sequence[tuple], function: object) -> list[object]:
    """What `function` (the reference or a known mistake) gives a case, errors as exceptions."""
    if not exercise.asks_for_a_function:
        return [function() if callable(function) else function]
    results: list[object] = []
    for case in cases:
        try:
            results.append(function(*case))
        except Exception as error:
            results.append(error)
    return results


def is_untouched(asked: Asked) -> bool:
    """Whether the answer is the stub as it stood in the notebook."""
    return bool(asked.outcomes) and all(
        isinstance(outcome, Blank)
        or (isinstance(outcome, Raised) and outcome.kind == "NotImplementedError")
        for outcome in asked.outcomes
    )


def diagnose(
    exercise: Exercise, asked: Asked, cases: Sequence[tuple], references: Sequence[object]
) -> str | None:
    """One line about what is wrong with the answer; None if it is right."""
    if asked.misuse:
        return asked.misuse
    wrong = [i for i, verdict in enumerate(asked.verdicts) if verdict is not True]
    if not wrong:
        return asked.changed and (
            f"the numbers are right, but the function changes its argument {asked.changed} "
            f"in place: work on a copy, {asked.changed} = np.array({asked.changed})"
        )
    outcome, first = asked.outcomes[wrong[0]], wrong[0]
    told = _told(exercise, cases[first])
    if isinstance(outcome, Raised) and not isinstance(references[first], Exception):
        return f"it stops with {outcome.text}{told if first else ''}"
    with np.errstate(all="ignore"):
        known = _known_mistake(exercise, asked, cases, references)
        if known:
            return known
        for i in wrong:
            malformed = _malformed(asked.outcomes[i], references[i])
            if malformed:
                return malformed + _told(exercise, cases[i])
        remark = next((asked.verdicts[i] for i in wrong if asked.verdicts[i] is not False), None)
        if remark:
            return remark
        if isinstance(outcome, Numbers) and not exercise.compare:
            right = len(cases) - len(wrong)
            share = f"right for {right} of {len(cases)} inputs; for the others " if right else ""
            asked, cases, references = (
                Asked([asked.outcomes[i] for i in wrong]),
                [cases[i] for i in wrong],
                [references[i] for i in wrong],
            )
            return share + (
                _transformed(exercise, asked, cases, references)
                or _differs(exercise, asked, cases, references)
            )
        if not exercise.asks_for_a_function:
            return f"{show(_value(outcome))} is not it"
        return (
            f"right for {len(asked.verdicts) - len(wrong)} of {len(cases)} inputs; wrong, for "
            f"example, is the {show(_value(outcome))} that it returns{told}"
        )


def _value(outcome: object) -> object:
    return outcome if isinstance(outcome, str) else outcome.value


def _told(exercise: Exercise, case: tuple) -> str:
    names = exercise.argument_names(len(case))
    told = ", ".join(f"{name} = {show(one)}" for name, one in zip(names, case, strict=True))
    return f", for {told}" if told else ""


def _known_mistake(
    exercise: Exercise, asked: Asked, cases: Sequence[tuple], references: Sequence[object]
) -> str | None:
    def outcomes(values: Sequence[object]) -> list[object]:
        return [
            Raised(type(value).__name__, "")
            if isinstance(value, Exception)
            else plain(value, reference)
            for value, reference in zip(values, references, strict=True)
        ]

    def same(one: Sequence[object], other: Sequence[object]) -> bool:
        pairs = zip(one, other, strict=True)
        return all(agree(a, b, exercise) for a, b in pairs)

    right = outcomes(references)
    for mistake in exercise.mistakes:
        wrong = outcomes(expected(exercise, cases, mistake.wrong))
        if same(asked.outcomes, wrong) and not same(wrong, right):
            return mistake.diagnosis
    return None


def _malformed(outcome: object, reference: object) -> str | None:
    if isinstance(reference, Exception):
        kind = type(reference).__name__
        if isinstance(outcome, Raised):
            return f"it stops with {outcome.text} where {kind} is expected"
        return f"it should raise {kind}, but it returns"
    if isinstance(outcome, Blank):
        return "it returns None for some inputs"
    if isinstance(outcome, Odd):
        return f"it is {outcome.text}" if reference is None else f"it returns {outcome.text}"
    if not isinstance(outcome, Numbers):
        return None
    wanted = plain(reference, reference).parts
    for part, other in zip(outcome.parts, wanted, strict=True):
        if part.shape != other.shape:
            text = f"{_form(part)} where {_form(other)} is expected"
            if part.shape == other.shape[::-1]:
                text += " (transposed?)"
            elif part.size == other.size:
                text += " (reshape it)"
            return f"it returns {text}"
        if not np.isfinite(part).all() and np.isfinite(other).all():
            return f"it returns {'NaN' if np.isnan(part).any() else 'infinity'}"
    return None


def _form(array: NDArray) -> str:
    return f"an array of shape {array.shape}" if array.ndim else "a single number"


def _transformed(
    exercise: Exercise, asked: Asked, cases: Sequence[tuple], references: Sequence[object]
) -> str | None:
    right = [plain(reference, reference) for reference in references]
    count = len(right[0].parts) if isinstance(right[0], Numbers) else 0
    if not all(isinstance(one, Numbers) for one in (*asked.outcomes, *right)):
        return None
    text = _other_inputs(exercise, asked, cases)
    if text:
        return text
    for part in range(count):
        pairs = [
            (one.parts[part], other.parts[part])
            for one, other in zip(asked.outcomes, right, strict=True)
        ]
        ragged = len({other.shape for _, other in pairs}) > 1
        if np.asarray(references[0][part] if count > 1 else references[0]).dtype.kind == "b":
            continue
        join = np.concatenate if ragged else np.stack
        one, other = (
            join([pair[side].ravel() if ragged else pair[side] for pair in pairs])
            for side in (0, 1)
        )
        near = _nearness(exercise)
        if near(one, other).all():
            continue
        text = _whole(one, other, near) or (None if ragged else _pieces(one, other, near))
        if text:
            return text if count == 1 else f"value {part + 1} of {count}: {text}"
    return None


def _nearness(exercise: Exercise) -> Callable[[NDArray, NDArray], NDArray]:
    return lambda one, other: np.isclose(one, other, rtol=exercise.rtol, atol=exercise.atol)


def _other_inputs(exercise: Exercise, asked: Asked, cases: Sequence[tuple]) -> str | None:
    def each(change: Callable[[NDArray], NDArray]) -> Callable[[tuple], tuple]:
        def changed(case: tuple) -> tuple:
            return tuple(
                change(np.asarray(one)) if isinstance(one, float | np.ndarray) else one
                for one in case
            )

        return changed

    usual = {
        "it takes the input for degrees: it is in radians": each(np.radians),
        "it takes the input for radians: it is in degrees": each(np.degrees),
        "it turns the sign of the input": each(np.negative),
        "it takes the arguments in the reverse order": lambda case: case[::-1],
    }
    if not exercise.asks_for_a_function:
        return None
    for text, change in usual.items():
        results = expected(exercise, [change(case) for case in cases], exercise.reference)
        if any(isinstance(result, Exception) for result in results):
            continue
        if all(
            agree(outcome, plain(result, result), exercise)
            for outcome, result in zip(asked.outcomes, results, strict=True)
        ):
            return text
    return None


def _whole(one: NDArray, other: NDArray, near: Callable) -> str | None:
    """What is odd about all numbers alike: sign, transposition, factor, offset."""
    if near(-one, other).all():
        return "the sign is wrong everywhere"
    square = one.ndim > 2 and one.shape[-1] == one.shape[-2]
    if square and near(np.swapaxes(one, -1, -2), other).all():
        return "the matrix is transposed"
    if not one.any():
        return "it returns only zeros"
    if one.shape[0] > 1 and near(one, one[0]).all():
        return "it returns the same for every input"
    return _scaled(one, other, near) or _shifted(one, other, near)


def _scaled(one: NDArray, other: NDArray, near: Callable) -> str | None:
    factor = float(np.vdot(other, one).real / np.vdot(other, other).real)
    if not np.isfinite(factor) or not near(one, factor * other).all():
        return None
    for name, known in _FACTORS.items():
        if near(one, known * other).all():
            return f"it is off by the factor {name}"
        if near(one, -known * other).all():
            return f"it is off by the factor -{name}"
    return f"it is off by the constant factor {factor:.4g}" if _varies(other, near) else None


def _shifted(one: NDArray, other: NDArray, near: Callable) -> str | None:
    turns = (one - other) / (2 * pi)
    if one.size > 1 and near(turns, np.round(turns)).all() and np.ptp(turns) > 0.5:
        return "angles are off by whole turns: wrap them"
    offset = float(np.mean(one - other).real)
    if not near(one - offset, other).all():
        return None
    for name, known in _OFFSETS.items():
        if np.isclose(abs(offset), known):
            return f"it is {name} too {'large' if offset > 0 else 'small'}"
    if not _varies(other, near):
        return None
    size = "large" if offset > 0 else "small"
    return f"it is too {size} by the same {abs(offset):.4g} everywhere"


def _varies(other: NDArray, near: Callable) -> bool:
    return other.size > 1 and not near(other, other.flat[0]).all()


def _pieces(one: NDArray, other: NDArray, near: Callable) -> str | None:
    """What is odd about single components: their order, or which of them are wrong."""
    if one.ndim == 1:
        return None
    for axis, name in _axes(one):
        order = _order(np.moveaxis(one, axis, 1), np.moveaxis(other, axis, 1), near)
        if order:
            return f"the {name} are in another order: {', '.join(map(str, order))}"
    wrong = ~near(one, other).all(axis=0)
    if wrong.all():
        return None
    why = _whole(one[:, wrong], other[:, wrong], near)
    if not why and 2 * wrong.sum() > wrong.size:
        return None
    told = f"{_which(wrong)} wrong (counted from 0), the others are right"
    return f"{told}; there, {why}" if why else told


def _axes(one: NDArray) -> Iterator[tuple[int, str]]:
    if one.ndim == 2:
        yield 1, "components"
    elif one.ndim == 3:
        yield 1, "rows"
        yield 2, "columns"


def _order(one: NDArray, other: NDArray, near: Callable) -> list[int] | None:
    """Where the components of `other` stand in `one`, if they are all there."""
    size, order = one.shape[1], []
    if not 2 <= size <= 12:
        return None
    for i in range(size):
        places = [j for j in range(size) if near(one[:, j], other[:, i]).all() and j not in order]
        if not places:
            return None
        order.append(i if i in places else places[0])
    return [order.index(i) for i in range(size)]


def _which(wrong: NDArray) -> str:
    if wrong.ndim == 2:
        for axis, name in ((1, "row"), (0, "column")):
            lines = np.flatnonzero(wrong.any(axis=axis))
            if len(lines) < wrong.shape[1 - axis] and np.take(wrong, lines, 1 - axis).all():
                return f"{name}{_plural(lines)}"
    entries = ["[" + ", ".join(map(str, place)) + "]" for place in np.argwhere(wrong)]
    if len(entries) > 6:
        return f"{len(entries)} of {wrong.size} entries are"
    return f"entr{'y' if len(entries) == 1 else 'ies'} {', '.join(entries)} " + (
        "is" if len(entries) == 1 else "are"
    )


def _plural(lines: NDArray) -> str:
    listed = ", ".join(map(str, lines))
    return f" {listed} is" if len(lines) == 1 else f"s {listed} are"


def _differs(
    exercise: Exercise, asked: Asked, cases: Sequence[tuple], references: Sequence[object]
) -> str:
    value = asked.outcomes[0].value
    if not exercise.asks_for_a_function and np.ndim(value) == 0:
        return f"{show(value)} is too {'large' if value > references[0] else 'small'}"
    error = max(
        float(np.max(np.abs(part - other), initial=0.0))
        for outcome, reference in zip(asked.outcomes, references, strict=True)
        for part, other in zip(outcome.parts, plain(reference, reference).parts, strict=True)
    )
    told = _told(exercise, cases[0])
    return f"it gives {show(value)}{told}; the largest error is {error:.3g}"

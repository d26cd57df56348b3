"""No mutant of a reference may pass its check: what students write almost right is noticed.

A mutant is the reference with one plain fault in what it is given or in what it returns: abs, the
other sign, zero for what is negative, whole numbers, the order along an axis, the last sample
forgotten, even steps, a constant taken from the first case, an argument that is changed in place.
One that answers all cases of the check rightly is a survivor, unless it is the reference in
disguise: it differs nowhere near the cases either (`probes`), or the exercise's oracle accepts what
it gives, or the lesson's oracles declare it equal, with the reason:

    EQUAL = {"4.3": {"abs of dt": "a time step is positive"}}
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache, partial
from itertools import combinations, permutations

import numpy as np
import pytest

from backhoe.course import catalogue
from backhoe.course.checking.answers import Trial, ask, prepare
from backhoe.lessons.exercise import Exercise
from lessons.test_oracles import EXERCISES, oracle_of, oracles

Change = Callable[[np.ndarray], object]
FEW = 8
"""Up to so many components of an array are changed one by one; more are samples."""
MANY = 12
"""So many arguments are changed to look for a difference that the cases do not show."""


def numeric(value: object) -> bool:
    return isinstance(value, int | float | np.number | np.bool_ | np.ndarray)


def mapped(value: object, change: Change) -> object:
    """The value with `change` made to each array and number in it; the rest stays."""
    if callable(value) and not is_dataclass(value):
        return lambda *arguments: mapped(value(*arguments), change)
    if is_dataclass(value) and not isinstance(value, type):
        parts = {one.name: mapped(getattr(value, one.name), change) for one in fields(value)}
        return replace(value, **parts)
    if isinstance(value, tuple | list):
        parts = [mapped(one, change) for one in value]
        return type(value)(*parts) if hasattr(value, "_fields") else type(value)(parts)
    if not numeric(value):
        return value
    changed = change(np.asarray(value))
    return changed if isinstance(value, np.ndarray) else np.asarray(changed)[()]


def at(place: tuple, change: Change) -> Change:
    """The change at one component of the last axis alone."""

    def there(array: np.ndarray) -> np.ndarray:
        if array.ndim == 0 or place[0] >= array.shape[-1]:
            return array
        array = array.copy()
        array[..., place[0]] = change(array[..., place[0]])
        return array

    return there


def on_arrays(change: Change) -> Change:
    return lambda array: change(array) if array.ndim and array.shape[0] > 1 else array


def negative(array: np.ndarray) -> np.ndarray:
    return ~array if array.dtype == bool else -array


def floats(change: Change) -> Change:
    return lambda array: array if array.dtype == bool else change(array)


def _first_repeated(array: np.ndarray) -> np.ndarray:
    return np.concatenate((array[1:2], array[1:]))


def _last_repeated(array: np.ndarray) -> np.ndarray:
    return np.concatenate((array[:-1], array[-2:-1]))


def _last_zero(array: np.ndarray) -> np.ndarray:
    return np.concatenate((array[:-1], np.zeros_like(array[-1:])))


PLAIN = {
    "abs": floats(np.abs),
    "the other sign": negative,
    "zero for negative": floats(lambda array: np.maximum(array, 0)),
    "whole numbers": floats(np.trunc),
}
ALONG = {
    "reversed along the last axis": on_arrays(lambda array: array[..., ::-1]),
    "rolled along the first axis": on_arrays(lambda array: np.roll(array, 1, axis=0)),
    "the last sample repeats the one before": on_arrays(_last_repeated),
    "the first sample is the second": on_arrays(_first_repeated),
    "the last sample is zero": on_arrays(_last_zero),
}
RESULTS = {
    **PLAIN,
    **ALONG,
    "zero": np.zeros_like,
    "one too many": floats(lambda array: array + 1 if array.dtype.kind in "iu" else array),
    "one too few": floats(lambda array: array - 1 if array.dtype.kind in "iu" else array),
}


def increasing(array: np.ndarray) -> bool:
    """Whether it could be times."""
    return bool(array.ndim == 1 and array.size > 2 and (np.diff(array) > 0).all())


def even(array: np.ndarray) -> np.ndarray:
    """Times with equal steps between the same ends."""
    return np.linspace(array[0], array[-1], array.size) if increasing(array) else array


ARGUMENTS = {
    **PLAIN,
    **ALONG,
    "counted from its first sample": on_arrays(lambda array: array - array[0]),
}


@dataclass
class Mutant:
    """`given` changes the arguments, `result` what the reference returned for them."""

    name: str
    given: Callable[[tuple], tuple] | None = None
    result: Callable[[object, int], object] | None = None
    spoils: int | None = None
    path: tuple | None = None

    def answer(self, trial: Trial, place: int, arguments: tuple) -> object:
        """What the mutant returns where it is called with this case."""
        value = trial.references[place]
        changed = self.given(arguments) if self.given else arguments
        if changed is not arguments or callable(value):
            return trial.exercise.reference(*changed)
        if isinstance(value, Exception):
            raise value
        return self.result(value, place) if self.result else value


def width(values: list[object]) -> int:
    """How many components of a last axis are changed one by one."""
    sizes = [value.shape[-1] for value in values if isinstance(value, np.ndarray) and value.ndim]
    return max(sizes, default=0) if max(sizes, default=0) <= FEW else 0


def parts(value: object) -> list[object]:
    if isinstance(value, tuple | list):
        return [leaf for one in value for leaf in parts(one)]
    if is_dataclass(value):
        return [leaf for one in fields(value) for leaf in parts(getattr(value, one.name))]
    return [value]


def of_the_result(trial: Trial) -> Iterator[Mutant]:
    """Mutants in what is returned, in all of it and in single components."""

    def made(change: Change) -> Callable[[object, int], object]:
        return lambda value, place: mapped(value, change)

    usual = [value for value in trial.references if not isinstance(value, Exception)]
    if all(callable(value) and not is_dataclass(value) for value in usual):
        usual = []
    for name, change in RESULTS.items():
        yield Mutant(f"the result: {name}", result=made(change))
    if trial.exercise.compare:  # many answers are right, and the trial of one is long
        return
    for j in range(width([leaf for value in usual for leaf in parts(value)])):
        for name, change in PLAIN.items():
            yield Mutant(f"the result at [{j}]: {name}", result=made(at((j,), change)))
    if usual and isinstance(usual[0], tuple):
        for k, first in enumerate(usual[0]):
            for name, change in RESULTS.items() if numeric(first) else ():
                yield Mutant(f"value {k} of the result: {name}", result=_part(k, change))
    if trial.exercise.asks_for_a_function and len(trial.cases) > 1:
        yield Mutant("the result of the first case", result=lambda value, place: usual[0])
        yield Mutant(
            "right for the first case, zero for the others",
            result=lambda value, place: mapped(value, np.zeros_like) if place else value,
        )


def _part(k: int, change: Change) -> Callable[[object, int], object]:
    def changed(value: object, place: int) -> object:
        kept = [mapped(one, change) if i == k else one for i, one in enumerate(value)]
        return type(value)(*kept) if hasattr(value, "_fields") else tuple(kept)

    return changed


def leaves(value: object, path: tuple = ()) -> Iterator[tuple[tuple, object]]:
    """Path and value of each number or array in an argument, objects opened."""
    if numeric(value):
        yield path, value
    elif isinstance(value, tuple | list):
        for i, one in enumerate(value):
            yield from leaves(one, (*path, i))
    elif is_dataclass(value):
        for one in fields(value):
            yield from leaves(getattr(value, one.name), (*path, one.name))


def put(value: object, path: tuple, leaf: object) -> object:
    """The argument with another leaf."""
    if not path:
        return leaf
    if isinstance(path[0], str):
        return replace(value, **{path[0]: put(getattr(value, path[0]), path[1:], leaf)})
    changed = list(value)
    changed[path[0]] = put(value[path[0]], path[1:], leaf)
    return type(value)(*changed) if hasattr(value, "_fields") else type(value)(changed)


def _with(path: tuple, change: Change) -> Callable[[tuple], tuple]:
    def given(arguments: tuple) -> tuple:
        for there, leaf in leaves(arguments):
            if there == path:
                changed = change(np.array(leaf))
                if np.array_equal(changed, leaf):
                    return arguments
                changed = changed if isinstance(leaf, np.ndarray) else np.asarray(changed).item()
                return put(arguments, path, changed)
        return arguments

    return given


def _of_the_first(first: object) -> Change:
    first = np.asarray(first)
    return lambda array: first.copy() if first.shape == array.shape else array


def _component_of_the_first(first: object, j: int) -> Change:
    def change(array: np.ndarray) -> np.ndarray:
        if np.shape(first)[-1:] != array.shape[-1:] or j >= array.shape[-1]:
            return array
        array = array.copy()
        array[..., j] = np.asarray(first)[..., j].reshape(-1)[0]
        return array

    return change


def of_the_arguments(trial: Trial) -> Iterator[Mutant]:
    """Mutants in what the reference is given, argument by argument and component by component."""
    if not trial.exercise.asks_for_a_function:
        return
    first = trial.cases[0]
    names = trial.exercise.argument_names(len(first))
    for k, argument in enumerate(first):
        if isinstance(argument, np.ndarray | list | dict):
            yield Mutant(f"{names[k]} is changed in place", spoils=k)
    if trial.exercise.compare:
        return
    cases = [dict(leaves(case)) for case in trial.cases]
    for path, leaf in cases[0].items():
        called = ".".join([names[path[0]], *map(str, path[1:])])
        others = [case[path] for case in cases[1:] if path in case]
        if np.asarray(leaf).dtype.kind not in "fiub":
            continue
        changes = {} if len(path) > 1 else ARGUMENTS if np.ndim(leaf) else PLAIN
        if len(path) == 1 and all(increasing(np.asarray(one)) for one in (leaf, *others)):
            changes = {**changes, "even steps": even}
        changes = {(called, name): change for name, change in changes.items()}
        named = len(path) == 1 and len({np.shape(one)[-1:] for one in (leaf, *others)}) == 1
        components = range(width([leaf]) if named else 0)  # columns of pictures have no meaning
        for j in components:
            for name in ("abs", "zero for negative"):
                changes[f"{called}[{j}]", name] = at((j,), PLAIN[name])
        if any(np.shape(one) == np.shape(leaf) for one in others):
            changes[called, "that of the first case"] = _of_the_first(leaf)
            for j in components:
                change = _component_of_the_first(leaf, j)
                changes[f"{called}[{j}]", "that of the first case"] = change
        for name, change in changes.items():
            yield Mutant(": ".join(name), given=_with(path, change), path=path)
    for i, j in combinations(range(len(first)), 2):
        if numeric(first[i]) and numeric(first[j]) and np.shape(first[i]) == np.shape(first[j]):
            yield Mutant(f"{names[i]} in the place of {names[j]}", given=_one_for_the_other(i, j))
            yield Mutant(f"{names[i]} and {names[j]} swapped", given=_swapped(i, j))
    for i, j in permutations(range(len(first)), 2):
        if isinstance(first[i], np.ndarray) and isinstance(first[j], np.ndarray):
            if first[i].ndim and first[j].ndim:
                name = f"{names[i]} cut to the length of {names[j]}"
                yield Mutant(name, given=_cut(i, j), path=(i,))


def _one_for_the_other(i: int, j: int) -> Callable[[tuple], tuple]:
    def given(arguments: tuple) -> tuple:
        if np.shape(arguments[i]) != np.shape(arguments[j]):
            return arguments
        return (*arguments[:j], copy.deepcopy(arguments[i]), *arguments[j + 1 :])

    return given


def _swapped(i: int, j: int) -> Callable[[tuple], tuple]:
    def given(arguments: tuple) -> tuple:
        arguments = list(arguments)
        arguments[i], arguments[j] = arguments[j], arguments[i]
        return tuple(arguments)

    return given


def _cut(i: int, j: int) -> Callable[[tuple], tuple]:
    def given(arguments: tuple) -> tuple:
        short = len(arguments[j])
        if len(arguments[i]) <= short:
            return arguments
        return (*arguments[:i], arguments[i][:short], *arguments[i + 1 :])

    return given


def _spoil(argument: object) -> None:
    if isinstance(argument, np.ndarray):
        argument[...] = ~argument if argument.dtype == bool else argument + 1
    else:
        argument.clear()


def passes(trial: Trial, mutant: Mutant) -> bool:
    """Whether the check takes the mutant for right; it is not asked beyond the first wrong case."""
    for place in range(len(trial.cases)):

        def answer(*arguments: object, place: int = place) -> object:
            value = mutant.answer(trial, place, arguments)
            if mutant.spoils is not None:
                _spoil(arguments[mutant.spoils])
            return value

        one = Trial(trial.exercise, [trial.cases[place]], [trial.references[place]])
        value = answer if trial.exercise.asks_for_a_function else answer()
        ask(value, one)
        if one.misuse or one.changed or one.verdicts != [True]:
            return False
    return True


def probes(trial: Trial, path: tuple) -> Iterator[tuple]:
    """Cases with another argument: its sign turned, its size changed, its steps uneven."""
    rng = np.random.default_rng(14)
    for case in trial.cases[:2]:
        leaf = dict(leaves(case)).get(path)
        array = np.asarray(leaf)
        if array.dtype.kind not in "fiu":
            continue
        inside = len(path) > 1  # an object has many numbers
        larger = [lambda a: (a * 1.37).astype(a.dtype), lambda a: a + 1]
        changes = [np.negative, *larger]
        for j in range(min(4, width([leaf]))):
            changes += [at((j,), np.negative), at((j,), larger[0])]
        if increasing(array):
            steps = np.diff(array) * rng.uniform(0.5, 1.5, array.size - 1)
            uneven = np.cumsum(np.concatenate(([float(array[0])], steps)))
            changes.append(lambda a, uneven=uneven: uneven)
        if array.ndim and len(array) > 1:
            changes.append(_one_more)
        for change in changes[1:2] if inside else changes:
            with suppress(Exception):
                yield _with(path, change)(copy.deepcopy(case))


def _one_more(array: np.ndarray) -> np.ndarray:
    return np.concatenate((array, 2 * array[-1:] - array[-2:-1]))


def beyond(trial: Trial, path: tuple) -> Trial:
    """The probes of an argument that the reference answers, as another trial."""
    cases, rights = [], []
    for case in probes(trial, path):
        with suppress(Exception):
            right = trial.exercise.reference(*copy.deepcopy(case))
            if all(np.isfinite(np.asarray(leaf)).all() for _, leaf in leaves(right)):
                cases.append(case), rights.append(right)
    return Trial(trial.exercise, cases, rights)


def the_oracle_accepts(trial: Trial, mutant: Mutant) -> bool:
    """Whether the oracle of an exercise with many right answers calls the mutant's right too."""
    for place, case in enumerate(trial.cases):
        try:
            value = mutant.answer(trial, place, copy.deepcopy(case))
            oracle_of(trial.exercise)(value, *copy.deepcopy(case))
        except Exception:
            return False
    return True


def changes_nothing(trial: Trial, mutant: Mutant) -> bool:
    """Whether the mutant returns what the reference does, as where a number is made no integer."""
    for place, right in enumerate(trial.references):
        if callable(right) and not is_dataclass(right):
            return False
        pairs = zip(leaves(mutant.result(right, place)), leaves(right), strict=True)
        if not all(np.array_equal(one, other) for (_, one), (_, other) in pairs):
            return False
    return True


def declared_equal(exercise: Exercise) -> dict[str, str]:
    """The mutants that the lesson declares equal, with the reason."""
    declared = getattr(oracles(catalogue.LESSONS[exercise.number.split(".")[0]]), "EQUAL", {})
    return declared.get(exercise.number, {})


def survivors(exercise: Exercise) -> list[str]:
    """Names of the mutants that the check takes for right though they are not the reference.

    Where all of an argument may be changed its components are not named one by one, and what may
    be either abs or zero where it is negative is never negative.
    """
    trial, found = prepare(exercise), []
    paths = [path for path, _ in leaves(trial.cases[0])][:MANY]
    further = cache(partial(beyond, trial))
    with np.errstate(all="ignore"):
        for mutant in (*of_the_result(trial), *of_the_arguments(trial)):
            if re.sub(r"( at )?\[\d+\]", "", mutant.name) in found or not passes(trial, mutant):
                continue
            if mutant.spoils is not None:
                equal = False
            elif exercise.compare:
                equal = changes_nothing(trial, mutant) or the_oracle_accepts(trial, mutant)
            else:
                touched = paths if mutant.path is None else [mutant.path]
                equal = all(passes(further(path), mutant) for path in touched)
            if not equal:
                found.append(mutant.name)
    for name in [one.removesuffix(": abs") for one in found if one.endswith(": abs")]:
        if f"{name}: zero for negative" in found:
            found[found.index(f"{name}: abs")] = f"{name} is never negative"
            found.remove(f"{name}: zero for negative")
    return found


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda exercise: exercise.number)
def test_no_mutant_of_a_reference_passes_its_check(exercise):
    found, declared = survivors(exercise), declared_equal(exercise)
    assert all(reason.strip() for reason in declared.values())
    assert not set(found) - set(declared), f"exercise {exercise.number} takes these for right"
    assert not set(declared) - set(found), "declared equal, but they do not survive any more"

"""Wrong input at every public function of some packages: a right answer, or an error that names it.

A table has one valid call of each; each argument in turn, then pairs of them, become what they must
not be. Allowed are a result, or a ValueError or TypeError that names an argument and says what was
expected or what came; no other error, no crash, no lack of memory, no changed input.
"""

from __future__ import annotations

import contextlib
import inspect
import re
import warnings
from collections.abc import Callable, Collection, Iterable
from types import ModuleType

import numpy as np

Table = dict[str, tuple[Callable, dict]]
"""A function and one valid call's arguments under its name."""


def public(packages: Iterable[ModuleType], results: Collection[str]) -> set[str]:
    """Names of all public functions, classes and methods of some packages, but for those that are
    made by functions, not by hand."""
    names = set()
    for package in packages:
        for name in package.__all__:
            thing = getattr(package, name)
            if name in results or not callable(thing):
                continue
            names.add(name)
            if inspect.isclass(thing):
                names |= {
                    f"{name}.{key}"
                    for key, value in vars(thing).items()
                    if not key.startswith("_")
                    and f"{name}.{key}" not in results
                    and (inspect.isfunction(value) or isinstance(value, classmethod))
                }
    return names


def method(make: Callable, name: str) -> Callable:
    """A method of a new object as a function of its arguments."""

    def call(**given: object) -> object:
        return getattr(make(), name)(**given)

    call.__signature__ = inspect.signature(getattr(type(make()), name))
    return call


def assert_complete(table: Table, names: set[str]) -> None:
    """Every name has its call, with all its arguments."""
    assert set(table) == names
    for name, (function, given) in table.items():
        parameters = inspect.signature(function).parameters.values()
        wanted = {p.name for p in parameters if p.kind is not p.VAR_KEYWORD and p.name != "self"}
        more = any(p.kind is p.VAR_KEYWORD for p in parameters)
        assert wanted <= set(given) if more else wanted == set(given), name


def assert_answers_or_names(
    function: Callable, given: dict, said: dict[str, tuple], seed: int = 0, slow: bool = False
) -> None:
    """The valid call answers; of a slow one not each value is tried, and no pairs."""
    function(**given)
    faults = []
    with little_memory():
        for one, good in given.items():
            for value in hostile(good)[:: 3 if slow else 1]:
                found = fault(function, {**given, one: value}, [one], said)
                if found:
                    faults.append(f"{one} = {shown(value)}: {found}")
        rng = np.random.default_rng(seed)
        for _ in range(0 if len(given) < 2 or slow else 60):
            pair = [str(one) for one in rng.choice(list(given), 2, replace=False)]
            wrong = {
                one: (values := hostile(given[one]))[rng.integers(len(values))] for one in pair
            }
            found = fault(function, {**given, **wrong}, pair, said)
            if found:
                faults.append(f"{ {k: shown(v) for k, v in wrong.items()} }: {found}")
    assert not faults, f"{len(faults)} faults\n" + "\n".join(faults[:40])


SCALARS = [
    None, "", "three", b"3", True, np.bool_(True), float("nan"), float("inf"), -float("inf"), 0, -1,
    1.5, 2.5, 7, 10**30, -(10**30), 1e-320, 1e-12, 1e300, 3 + 4j, [], {}, (), object(), len, int,
    np.zeros(0), np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((2, 2, 2, 2)), [[1, 2], [3]], "NaN",
    [None, None], np.array(["a", "b", "c"]), np.array(None), range(3), {1, 2}, np.float32(1.5),
    np.datetime64("2020-01-01"), np.array(0.3), [[], []],
]  # fmt: skip


def hostile(good: object) -> list:
    """What is put in the place of a good argument."""
    values = list(SCALARS)
    if isinstance(good, (list, tuple)):
        values += [[], good[:1], [*good, *good], [*good, None], good[0], [None] * len(good)]
    if isinstance(good, dict):
        values += [
            {k: None for k in good},
            {k: [] for k in good},
            {"other": 3},
            {3: good},
        ]
        values += [{k: [None] for k in good}, {k: 7 for k in good}]
    if isinstance(good, np.ndarray):
        spoilt = [good.astype(float) for _ in range(4)]
        for array, value in zip(spoilt, (np.nan, np.inf, 1e300, -1e-310), strict=True):
            array.flat[array.size // 2] = value
        values += [
            *spoilt,
            good[None],
            good[:1],
            good[:0],
            good[..., :-1],
            good[..., None],
            good[0],
        ]
        values += [np.concatenate([good, good], axis=-1), np.concatenate([good] * 2), good[::-1]]
        values += [
            good.astype(kind) for kind in (object, str, complex, bool, int, np.float32, "f2")
        ]
        values += [good * 1e300, good * 1e-300, good * 0.0, -1.0 * good, good + 1e9, good * np.nan]
        values += [np.asfortranarray(good), good.tolist(), np.ma.masked_array(good, good == good)]
        values += [np.ma.masked_array(good), good.astype(">f8"), np.full_like(good, 5), good.T]
    return values


def frozen(value: object) -> object:
    """A copy to compare with."""
    if isinstance(value, np.ndarray):
        return value.copy(), value.dtype
    if isinstance(value, dict):
        return {key: frozen(one) for key, one in value.items()}
    return tuple(map(frozen, value)) if type(value) in (list, tuple) else value


def unchanged(value: object, kept: object) -> bool:
    if isinstance(value, np.ndarray):
        return value.dtype == kept[1] and value.tobytes() == kept[0].tobytes()
    if isinstance(value, dict):
        return all(unchanged(value[key], one) for key, one in kept.items())
    if type(value) in (list, tuple):
        return all(map(unchanged, value, kept))
    return True


@contextlib.contextmanager
def little_memory():
    """At most 2 GiB more than now, where the system can limit it."""
    try:
        import resource

        with open("/proc/self/statm") as file:
            now = int(file.read().split()[0]) * resource.getpagesize()
    except (ImportError, OSError):
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (now + (2 << 30), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def fault(
    function: Callable, given: dict, changed: list[str], said_of: dict[str, tuple]
) -> str | None:
    """What is wrong with how a function takes these arguments; None for nothing.

    `said_of` has the words that stand for an argument in an error.
    """
    kept = {name: frozen(value) for name, value in given.items()}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            function(**given)
    except (ValueError, TypeError) as error:
        said = str(error)
        names = {name for one in given for name in (one, one.rstrip("s"), *said_of.get(one, ()))}
        if not any(re.search(rf"(?<![A-Za-z]){re.escape(name)}", said) for name in names):
            return f"does not name {' or '.join(changed)}: {type(error).__name__}: {said[:150]}"
        if not re.search(r"\b(must|got|need|leave|open|cannot|claims|damaged)\b", said):
            return f"says nothing of what is expected: {said[:150]}"
    except Exception as error:
        return f"{type(error).__name__}: {str(error)[:150]}"
    if not all(unchanged(given[name], kept[name]) for name in given):
        return "changes its input"
    return None


def shown(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"<{value.shape} {value.dtype} {np.array2string(value.ravel()[:3])}>"[:90]
    return repr(value)[:60]

"""Primitives by name: kept in files that a person can read, one after the other, blended.

A file holds the settings and the weights of one primitive as JSON; its name is the primitive's.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from backhoe.basics import inputs
from backhoe.planning.dmp.phase import minimum_jerk
from backhoe.planning.dmp.primitive import DMP
from backhoe.planning.dmp.spring import whole_steps

_SETTINGS = ("stiffness", "damping", "tau", "formulation", "fit", "ridge", "smoothing")
_KERNELS = ("width", "spacing", "end_phase")
_NUMBERS = ("duration", "step")
_ARRAYS = ("start", "goal", "velocities", "weights")


class Library(Mapping):
    """Primitives by name: `library["dig"].rollout(...)`.

    Args:
        primitives: learnt ones by their names.

    Raises:
        TypeError: something else than primitives.
        ValueError: a name that is no plain word.
    """

    def __init__(self, primitives: Mapping[str, DMP]) -> None:
        inputs.instance(primitives, "primitives", Mapping)
        for name, one in primitives.items():
            if not (isinstance(name, str) and name.replace("-", "_").isidentifier()):
                raise ValueError(f"a primitive's name must be a plain word, got {name!r}")
            inputs.instance(one, f"primitives[{name!r}]", DMP)
        self._primitives = dict(primitives)

    def __getitem__(self, name: str) -> DMP:
        return self._primitives[inputs.choice(name, "primitive", tuple(self._primitives))]

    def __iter__(self) -> Iterator[str]:
        return iter(self._primitives)

    def __len__(self) -> int:
        return len(self._primitives)

    def save(self, folder: str | Path) -> None:
        """Write a file `<name>.json` for each primitive into the folder, made if need be.

        Raises:
            TypeError: folder is neither text nor a Path.
        """
        folder = _folder(folder)
        folder.mkdir(parents=True, exist_ok=True)
        for name, one in self.items():
            text = json.dumps(_written(one), indent=1)
            (folder / f"{name}.json").write_text(text + "\n", encoding="utf-8")

    @classmethod
    def load(cls, folder: str | Path) -> Library:
        """The primitives of a folder's files.

        Raises:
            ValueError: a folder without such files, or a file that is none of them.
            TypeError: folder is neither text nor a Path.
        """
        files = sorted(_folder(folder).glob("*.json"))
        if not files:
            raise ValueError(f"folder must hold primitives, <name>.json, got {str(folder)!r}")
        return cls({file.stem: _read(file) for file in files})


def _folder(given: str | Path) -> Path:
    return Path(inputs.instance(given, "folder", (str, Path)))


def _written(one: DMP) -> dict:
    words = {name: getattr(one, name) for name in _SETTINGS}
    words |= {"kernels": one.kernels.count} | {k: getattr(one.kernels, k) for k in _KERNELS}
    learnt = {name: getattr(one._learnt(), name) for name in _NUMBERS}
    return words | learnt | {name: getattr(one, name).tolist() for name in _ARRAYS}


def _read(file: Path) -> DMP:
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
        one = DMP(kernels=kept["kernels"], **{k: kept[k] for k in (*_SETTINGS, *_KERNELS)})
        one.duration, one.step = (inputs.positive(kept[k], k, "s") for k in _NUMBERS)
        one.start = inputs.numbers(kept["start"], "start", ("d",))
        d = len(one.start)
        shapes = (d,), (2, d), (one.kernels.count, d)
        for name, shape in zip(_ARRAYS[1:], shapes, strict=True):
            setattr(one, name, inputs.numbers(kept[name], name, shape))
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{file.name} must be a primitive as save writes it: {error}") from error
    return one


def sequence(
    primitives: Sequence[DMP],
    goals: Sequence[ArrayLike | None] | None = None,
    durations: Sequence[float | None] | None = None,
    start: ArrayLike | None = None,
    dt: float = 0.01,
    blend: float = 0.0,
    **options: object,
) -> tuple[NDArray, NDArray, NDArray]:
    """Primitives one after the other, each from where, and as fast as, the one before has come.

    Args:
        primitives: learnt, of the same dimensions d.
        goals: one a primitive, shape (d,) [unit]; where None, the demonstrated one.
        durations: one a primitive, made whole steps [s]; where None, the demonstrated one.
        start: of the first, shape (d,) [unit]; the demonstrated one if None.
        dt: step [s].
        blend: how long before its end a primitive begins to give way to the next [s].
        options: for each roll-out, such as `remedy`, `exact_end`.

    Returns:
        Times (m,) [s], positions (m, d) [unit], velocities (m, d) [unit/s], both continuous.

    Raises:
        TypeError: something else than primitives.
        ValueError: none, other counts of goals or durations, a blend longer than a movement, or as
            for `DMP.rollout`.
    """
    primitives, dt = inputs.instances(primitives, "primitives", DMP), inputs.positive(dt, "dt", "s")
    if not primitives:
        raise ValueError("primitives must hold one or more, got none")
    goals, durations = (
        [None] * len(primitives) if x is None else inputs.instance(x, name, (list, tuple))
        for name, x in (("goals", goals), ("durations", durations))
    )
    if len(goals) != len(primitives) or len(durations) != len(primitives):
        raise ValueError(
            f"goals and durations must be one a primitive, {len(primitives)}, "
            f"got {len(goals)} and {len(durations)}"
        )
    blend = inputs.not_negative(blend, "blend", "s")
    shared = whole_steps(blend, dt) if blend else 0
    x = v = None
    for one, goal, duration in zip(primitives, goals, durations, strict=True):
        whole = one._learnt().duration if duration is None else duration
        steps = whole_steps(inputs.positive(whole, "durations", "s"), dt)
        if steps <= shared:
            raise ValueError(f"blend must be shorter than each movement, got {blend} s")
        options_ = {"goal": goal, "duration": steps * dt, "dt": dt, **options}
        if x is None:
            _, x, v = one.rollout(start, **options_)
            continue
        cut = len(x) - 1 - shared
        _, x2, v2 = one.rollout(x[cut], velocity=v[cut], **options_)
        if shared:
            m, slope, _ = minimum_jerk(np.linspace(0, 1, shared + 1)[:, None])
            apart = x2[: shared + 1] - x[cut:]
            v2[: shared + 1] = (1 - m) * v[cut:] + m * v2[: shared + 1] + slope * apart / blend
            x2[: shared + 1] = x[cut:] + m * apart
        x, v = np.vstack([x[:cut], x2]), np.vstack([v[:cut], v2])
    return dt * np.arange(len(x)), x, v

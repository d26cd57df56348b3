"""Check an exercise: one line that says not done yet, right, or what the likely mistake is.

    from backhoe.course import check

    check("1.2", my_function)   # or a value: check("0.1", 42.0)
    check.hint("1.2")           # a hint, the next one at each call
    check.solution("1.2")       # the source of the library's own function
    check.summary()             # what is done, in this notebook or earlier

Writing an exercise (in `backhoe/lessons/<lesson>/exercises/`, in the tuple `EXERCISES`):

    def _in_degrees(q):
        return kinematics.forward_kinematics(np.radians(q))

    Exercise(
        number="1.2",
        title="Where is the tip?",
        reference=kinematics.forward_kinematics,
        cases=lambda rng: [(rng.uniform(-0.8, 0.8, 4),) for _ in range(40)],
        oracle="the_same_by_pinocchio",  # in tests/lessons/<lesson>/oracles.py
        mistakes={
            "the angles are in radians already": _in_degrees,
            ...  # at least four, each with its own diagnosis
        },
        hints=("Which frame does each link turn in?", "Multiply the four transforms in order."),
        tested_on="40 random postures",
    )

Signs, factors, degrees, transposition, order, wrong components, wrong shapes, NaN and errors are
recognised without a mistake of your own; write one where you can say more. It is recognised when
its function gives the same outcomes as the answer, whatever their shape, NaN included.
"""

from __future__ import annotations

import inspect
import os
from collections import Counter
from functools import partial
from pathlib import Path

from backhoe.course.checking import guard, memory
from backhoe.course.checking.answers import ask, prepare
from backhoe.course.checking.diagnosis import diagnose, gives_nothing_back, is_untouched
from backhoe.course.checking.outcomes import show
from backhoe.lessons.exercise import Exercise, source_of, sources_of

__all__ = ["Check"]


class Check:
    """Checks exercises and remembers how they went, in the student's copy of the lessons.

    What it prints of an answer does not depend on what it remembers from before.

    Args:
        catalogue: where they are: find(number) and lesson(number) as in `backhoe.course.catalogue`.
    """

    def __init__(self, catalogue: object) -> None:
        self._catalogue = catalogue
        self._wrong, self._hints = Counter(), Counter()
        self._state: dict[str, str] = {}
        self._here: list[memory.Checked] = []

    def __call__(self, number: str, answer: object = None) -> None:
        """Print one line about `answer`; from its second wrong answer on, a hint below it.

        Args:
            number: the exercise, such as "1.2".
            answer: your function (not its result), or your value where a value is asked for.

        Raises:
            ValueError: there is no such exercise.
        """
        exercise = self._catalogue.find(number)
        verdict, right = self._judge(exercise, answer)
        print(f"exercise {exercise.number}: {verdict}")
        self._state[exercise.number] = "right" if right else verdict.partition(":")[0]
        if verdict == "not done yet":
            return
        one = memory.Checked.now(exercise.number, right)
        if not memory.remember(memory.copy_around(), [one]):
            self._here.append(one)
        self._wrong[exercise.number] += not right
        if not right and self._wrong[exercise.number] > 1:
            if self._hints[exercise.number] <= len(exercise.hints):
                self.hint(exercise.number)

    def hint(self, number: str) -> None:
        """Print the next hint of the exercise; after the last, where to look instead.

        Raises:
            ValueError: there is no such exercise.
        """
        exercise = self._catalogue.find(number)
        place, many = self._hints[exercise.number] + 1, len(exercise.hints)
        self._hints[exercise.number] = min(place, many + 1)
        if place <= many:
            text = f"hint {place} of {many}: {exercise.hints[place - 1]}"
        else:
            text = (
                f"no {'further ' * bool(many)}hints: read the section above it once more, or see "
                f'check.solution("{exercise.number}")'
            )
        print(f"exercise {exercise.number}: {text}")

    def solution(self, number: str) -> None:
        """Print the reference: the source of the function, with what it is made of, or the value.

        A teacher turns solutions off with the environment variable BACKHOE_SOLUTIONS=off.

        Raises:
            ValueError: there is no such exercise.
        """
        exercise = self._catalogue.find(number)
        if os.environ.get("BACKHOE_SOLUTIONS", "").strip().lower() == "off":
            print(f"exercise {exercise.number}: your teacher has turned the solutions off")
        elif callable(exercise.reference):
            function = source_of(exercise.reference)
            place = f"{function.__module__}.{function.__qualname__}"
            for name, value in getattr(exercise.reference, "keywords", {}).items():
                place += f", {name}={value!r}"
            print(f"exercise {exercise.number}: one solution, {place}:\n")
            print("\n\n".join(inspect.getsource(one).rstrip() for one in sources_of(function)))
        else:
            print(f"exercise {exercise.number}: the answer is {show(exercise.reference)}")

    def summary(self, folder: str | Path | None = None) -> None:
        """Print a table of the lessons that you have worked on, today or before.

        Args:
            folder: of your copy of the lessons; the one that this notebook lies in if None.
        """
        checks, said = memory.recall(Path(folder) if folder else memory.copy_around())
        passed = memory.passed([*checks, *self._here])
        states = {one.exercise: "not yet" for one in checks} | dict.fromkeys(passed, "right")
        states |= {
            number: state
            for number, state in self._state.items()
            if state != "not done yet" or number not in states
        }
        lessons = {number.split(".")[0] for number in states} & set(self._catalogue.written())
        for line in said if lessons else [*said, "no exercise checked yet"]:
            print(line)
        for lesson in sorted(lessons, key=int):
            of_lesson = self._catalogue.lesson(lesson)
            print(f"lesson {lesson}: {len(passed.keys() & of_lesson)} of {len(of_lesson)} right")
            for number, exercise in of_lesson.items():
                state, once = states.get(number, "not checked"), passed.get(number)
                when = f" (right {once.day}, try {once.tries})" if once else ""
                print(f"  {number:<5} {state:<13} {exercise.title}{when}")

    def _judge(self, exercise: Exercise, answer: object) -> tuple[str, bool]:
        trial = prepare(exercise)
        try:
            trial = guard.run(partial(ask, answer, trial), exercise.timeout)
        except guard.OutOfTime as out:
            verdict = f"not yet: no answer after {exercise.timeout:g} s; is there an endless loop?"
            if not out.stopped:
                verdict += " It cannot be stopped: restart the kernel"
            return verdict, False
        if is_untouched(trial):
            forgotten = gives_nothing_back(answer, trial)
            return (f"not yet: {forgotten}" if forgotten else "not done yet"), False
        diagnosis = diagnose(trial)
        if diagnosis:
            return f"not yet: {diagnosis}", False
        tested = exercise.tested_on
        if exercise.asks_for_a_function and not tested:
            tested = f"{len(trial.cases)} inputs"
        return f"right ({tested})" if tested else "right", True

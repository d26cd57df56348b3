"""The check answers calmly, in one line, whatever a student hands it."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import time
import warnings
from collections import namedtuple
from datetime import datetime
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from backhoe import machine
from backhoe.course import catalogue
from backhoe.course.checking import Check, guard, patterns
from backhoe.course.checking.answers import ask, prepare
from backhoe.course.checking.diagnosis import diagnose
from backhoe.lessons.exercise import Exercise


def turn(q):
    """A planar pose, shape (3, 3)."""
    c, s = np.cos(q[0]), np.sin(q[0])
    return np.array([[c, -s, q[1]], [s, c, q[2]], [0.0, 0.0, 1.0]])


def stretch(v):
    return 2 * v + 1


def slope(a, b):
    return a - 2 * b


def parts(v):
    return v[0] * v[1], v**2


def above(v):
    return bool(v[0] > 0)


def root(x):
    if x < 0:
        raise ValueError("no root")
    return np.sqrt(x)


def seven(pair):
    return 7.0


def four_thirds():
    return 4 / 3


def vectors(rng):
    return [(rng.uniform(-1, 1, 3),) for _ in range(20)]


def from_degrees(q):
    return turn(np.radians(q))


def beside_it(answer, reference, q):
    """Right is every point at distance 1 from q."""
    distance = np.linalg.norm(answer - q[:2])
    if not np.isclose(distance, 1.0):
        return f"the point is {distance:.2f} from q, it should be 1"
    return None


def neighbour(q):
    return q[:2] + np.array([1.0, 0.0])


EXERCISES = {
    exercise.number: exercise
    for exercise in (
        Exercise(
            "9.1",
            "A pose",
            turn,
            vectors,
            mistakes={
                "q is in radians already": from_degrees,
            },
            hints=("first", "second"),
            tested_on="20 random poses",
            timeout=2.0,
        ),
        Exercise("9.2", "A vector", stretch, vectors),
        Exercise("9.3", "Two arguments", slope, lambda rng: [tuple(rng.normal(size=2))] * 2),
        Exercise("9.4", "Two values", parts, vectors),
        Exercise("9.5", "Yes or no", above, vectors),
        Exercise("9.6", "An error", root, lambda rng: [(-1.0,), (4.0,), (9.0,)]),
        Exercise("9.7", "Many answers", neighbour, vectors, compare=beside_it),
        Exercise("9.8", "A number", four_thirds, rtol=1e-3),
        Exercise(
            "9.9",
            "A word",
            "boom",
            mistakes={
                "look again": "stick",
            },
        ),
        Exercise("9.10", "A row", np.array([1.0, 2.0, 3.0])),
        Exercise("9.11", "In a hurry", turn, vectors, timeout=0.3),
        Exercise(
            "9.12", "The machine", machine.Machine.mass.fget, lambda rng: [(machine.BACKHOE,)]
        ),
    )
}


OURS = SimpleNamespace(
    find=EXERCISES.__getitem__,
    lesson=lambda number: EXERCISES,
    written=lambda: ["9"],
)


@pytest.fixture
def ctrl_c():
    """Interrupts raise KeyboardInterrupt, also where a shell started pytest in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def said(monkeypatch, capsys):
    """What a fresh check prints about an answer, without the exercise's number."""

    def ask(number: str, answer: object, check: Check | None = None) -> str:
        result = (check or Check(OURS))(number, answer)
        assert result is None
        lines = capsys.readouterr().out.splitlines()
        assert len(lines) == 1 or check
        return lines[0].removeprefix(f"exercise {number}: ")

    return ask


class TestRight:
    def test_says_what_it_was_tested_on(self, said):
        assert said("9.1", turn) == "right (20 random poses)"

    def test_accepts_lists_for_arrays(self, said):
        assert said("9.1", lambda q: turn(q).tolist()).startswith("right")

    def test_accepts_a_value_within_its_tolerance(self, said):
        assert said("9.8", 1.3334) == "right"

    def test_refuses_a_value_beyond_its_tolerance(self, said):
        rtol = EXERCISES["9.8"].rtol
        assert said("9.8", 4 / 3 * (1 + 0.9 * rtol)) == "right"
        assert said("9.8", 4 / 3 * (1 + 1.1 * rtol)).startswith("not yet")

    def test_accepts_text_in_any_case(self, said):
        assert said("9.9", " Boom ") == "right"

    def test_accepts_every_answer_that_its_property_allows(self, said):
        assert said("9.7", lambda q: q[:2] + np.array([0.0, -1.0])).startswith("right")

    def test_accepts_the_expected_error(self, said):
        assert said("9.6", root).startswith("right")

    def test_accepts_several_values(self, said):
        assert said("9.4", parts).startswith("right")

    def test_accepts_partial_functions_and_callable_objects(self, said):
        assert said("9.3", partial(slope)).startswith("right")

    def test_hands_the_machine_over_as_it_is(self, said):
        assert said("9.12", lambda machine: machine.mass).startswith("right")


class TestNotDone:
    @pytest.mark.parametrize("stub", [None, ..., NotImplemented])
    @pytest.mark.parametrize("number", ["9.1", "9.8", "9.9"])
    def test_a_blank_value_is_not_done(self, said, number, stub):
        assert said(number, stub) == "not done yet"

    @pytest.mark.parametrize("result", [None, ..., NotImplemented])
    def test_a_function_that_returns_nothing_is_not_done(self, said, result):
        assert said("9.1", lambda q: result) == "not done yet"

    def test_a_stub_that_takes_its_arguments_apart_is_not_done(self, said):
        def stub(q):
            x, y, angle = q
            x = x, y, angle
            return None

        assert said("9.1", stub) == "not done yet"

    def test_a_forgotten_return_is_told(self, said):
        def forgot(q):
            q = 2 * turn(q)

        class Forgetful:
            def __call__(self, q):
                turn(q)

        for answer in (forgot, Forgetful(), partial(forgot), lambda q: turn(q).sort()):
            assert "it computes something, but returns None" in said("9.1", answer)

    def test_printing_instead_of_returning_is_told(self, said, capsys):
        def helper(q):
            print(turn(q))

        for answer in (print, helper, lambda q: helper(q)):
            assert "it prints, but returns None" in said("9.1", answer)

    def test_printing_beside_returning_is_right(self, said):
        def loud(q):
            print("here")
            return turn(q)

        assert said("9.1", loud).startswith("right")

    def test_a_tuple_of_nothing_is_not_done(self, said):
        assert said("9.4", lambda v: (None, None)) == "not done yet"

    def test_a_function_that_raises_not_implemented_is_not_done(self, said):
        def stub(q):
            raise NotImplementedError("your code here")

        assert said("9.1", stub) == "not done yet"

    def test_nothing_for_some_inputs_is_wrong(self, said):
        line = said("9.1", lambda q: turn(q) if q[0] > 0 else None)
        assert line.startswith("not yet: it returns None, for q = [")

    def test_not_implemented_for_some_inputs_is_wrong(self, said):
        def half(q):
            if q[0] < 0:
                raise NotImplementedError
            return turn(q)

        assert "it stops with NotImplementedError" in said("9.1", half)


PATTERNS = {
    "the sign is wrong everywhere": ("9.1", lambda q: -turn(q)),
    "the matrix is transposed": ("9.1", lambda q: turn(q).T),
    "it would be right for np.degrees of the input: degrees for radians?": (
        "9.1",
        lambda q: turn(np.degrees(q)),
    ),
    "it turns the sign of the input": ("9.1", lambda q: turn(-q)),
    "it takes the arguments in the reverse order": ("9.3", lambda a, b: slope(b, a)),
    "it is off by the factor pi": ("9.1", lambda q: turn(q) * np.pi),
    "it is off by the factor -2": ("9.1", lambda q: turn(q) * -2),
    "it is off by the factor 1/1000": ("9.1", lambda q: turn(q) / 1000),
    "it is off by the factor 9.81": ("9.1", lambda q: turn(q) * 9.81),
    "it is off by the factor 180/pi (degrees where radians are expected?)": (
        "9.2",
        lambda v: np.degrees(stretch(v)),
    ),
    "it is off by the constant factor 1.7": ("9.1", lambda q: turn(q) * 1.7),
    "it is off by 0.1 % everywhere: is a number rounded?": ("9.1", lambda q: turn(q) * 0.999),
    "it is pi/2 too small": ("9.2", lambda v: stretch(v) - np.pi / 2),
    "it is too small by the same 1 everywhere": ("9.2", lambda v: 2 * v),
    "angles are off by whole turns: wrap them": (
        "9.2",
        lambda v: stretch(v) + 2 * np.pi * (1 + (v > 0)),
    ),
    "the components are in the order 1, 2, 0": ("9.2", lambda v: stretch(v)[[1, 2, 0]]),
    "the rows are in the order 1, 0, 2": ("9.1", lambda q: turn(q)[[1, 0, 2]]),
    "the columns are in the order 0, 2, 1": ("9.1", lambda q: turn(q)[:, [0, 2, 1]]),
    "it is never negative where it should be: is there an abs too many?": (
        "9.1",
        lambda q: abs(turn(q)),
    ),
    "it is zero where it should be negative": ("9.1", lambda q: np.maximum(turn(q), 0)),
    "the numbers are whole": ("9.2", lambda v: stretch(v).astype(int)),
    "it returns only zeros": ("9.1", lambda q: np.zeros((3, 3))),
    "it returns the same for every input": ("9.1", lambda q: np.eye(3)),
    "entry [2] (counted from 0) is wrong, the others are right; there, the sign is wrong "
    "everywhere": ("9.2", lambda v: stretch(v) * [1, 1, -1]),
    "column 2 (counted from 0) is wrong, the others are right; there, it is off by the factor 2": (
        "9.1",
        lambda q: turn(q) * [1, 1, 2],
    ),
    "row 0 (counted from 0) is wrong, the others are right; there, the sign is wrong everywhere": (
        "9.1",
        lambda q: turn(q) * [[-1], [1], [1]],
    ),
    "value 2 of 2: it is off by the factor 1/2": ("9.4", lambda v: (v[0] * v[1], v**2 / 2)),
}


class TestPatterns:
    @pytest.mark.parametrize(("number", "answer"), PATTERNS.values(), ids=PATTERNS)
    def test_names_what_is_odd(self, said, number, answer, request):
        diagnosis = next(text for text, case in PATTERNS.items() if case[1] is answer)
        line = said(number, answer)
        assert line.removeprefix("not yet: ").startswith(diagnosis)

    def test_large_numbers_are_not_taken_for_angles(self):
        wanted = np.linspace(1e5, 2e5, 20)
        assert patterns.overall(wanted**1.01, wanted, partial(np.isclose, rtol=1e-3)) is None

    def test_says_how_many_inputs_are_right(self, said):
        line = said("9.2", lambda v: stretch(v) * (1 if v[0] > 0 else 3))
        assert line.startswith("not yet: right for ")
        assert line.endswith("of 20 inputs; for the others it is off by the factor 3")

    def test_shows_one_case_but_not_the_right_answer(self, said):
        line = said("9.2", lambda v: np.sin(v))
        v = EXERCISES["9.2"].inputs()[0][0]
        assert line.startswith(f"not yet: it gives [{np.sin(v[0]):.4g}, ")
        assert "for v = [" in line
        assert "the largest error is" in line
        assert f"{stretch(v)[0]:.3f}" not in line

    def test_yes_or_no_shows_the_case(self, said):
        assert "it gives False, for v = [" in said("9.5", lambda v: False)

    def test_a_known_mistake_is_named_before_any_pattern(self, said):
        assert said("9.1", from_degrees) == "not yet: q is in radians already"

    def test_a_property_speaks_for_itself(self, said):
        assert said("9.7", lambda q: q[:2] * 0 + q[:2]) == (
            "not yet: the point is 0.00 from q, it should be 1"
        )

    def test_a_property_that_cannot_use_the_answer_says_why(self, said):
        line = said("9.7", lambda q: np.ones(5))
        assert line.startswith("not yet: what it returns cannot be used: operands could not")

    def test_a_missing_error_is_named(self, said):
        line = said("9.6", lambda x: np.sqrt(abs(x)))
        assert line == "not yet: it returns no error where ValueError is expected, for x = -1"

    def test_another_error_is_named(self, said):
        line = said("9.6", lambda x: root(x) if x > 0 else 1 / 0)
        assert "stops with ZeroDivisionError" in line
        assert "where ValueError is expected" in line

    def test_a_number_is_too_large_or_too_small(self, said):
        assert said("9.8", 1.2) == "not yet: 1.2 is too small"
        assert said("9.8", 1.5) == "not yet: 1.5 is too large"

    def test_a_number_with_a_recognisable_factor_is_named(self, said):
        assert said("9.8", 4000 / 3) == "not yet: it is off by the factor 1000"

    def test_another_word_is_not_it(self, said):
        assert said("9.9", "bucket") == "not yet: 'bucket' is not it"
        assert said("9.9", "stick") == "not yet: look again"


def ragged(q):
    return [[1.0, 2.0], [3.0]]


def endless_recursion(q):
    return endless_recursion(q)


class Evil:
    def __array__(self, *arguments, **keywords):
        raise RuntimeError("no array for you")

    def __eq__(self, other):
        raise RuntimeError("not comparable")

    def __repr__(self):
        raise RuntimeError("not printable")

    __hash__ = None
    __str__ = __float__ = __len__ = __repr__

    @property
    def __class__(self):
        raise RuntimeError("no class")


class EvilError(Exception):
    def __str__(self):
        raise RuntimeError("no text")


class OwnBase(BaseException):
    pass


def raises(error):
    def function(q):
        raise error

    return function


FORMS = {
    "an array of shape (2, 3) where an array of shape (3, 3) is expected": lambda q: turn(q)[:2],
    "an array of shape (9,) where an array of shape (3, 3) is expected (reshape it)": (
        lambda q: turn(q).ravel()
    ),
    "a single number where an array of shape (3, 3) is expected": lambda q: 1.0,
    "a list that makes no array where an array of shape (3, 3) is expected": ragged,
    "text where an array of shape (3, 3) is expected": lambda q: "abc",
    "a dictionary where an array of shape (3, 3) is expected": lambda q: {"a": 1},
    "complex numbers": lambda q: turn(q) + 1j,
    "NaN": lambda q: turn(q) * np.nan,
    "infinity": lambda q: turn(q) + np.inf,
    "an array of shape (1000000000,)": lambda q: np.zeros(10**9),
    "an object of type function": lambda q: turn,
    "an object of type generator": lambda q: (x for x in q),
}


class TestForms:
    @pytest.mark.parametrize("form", FORMS)
    def test_names_the_form(self, said, form):
        assert said("9.1", FORMS[form]).startswith(f"not yet: it returns {form}")

    def test_names_a_wrong_number_of_values(self, said):
        assert said("9.4", lambda v: v).startswith("not yet: it returns an array of shape (3,)")
        assert "where 2 values are expected" in said("9.4", lambda v: 1.0)

    def test_names_a_value_that_is_transposed(self, said):
        assert "(reshape it)" in said("9.10", [[1.0], [2.0], [3.0]])

    def test_names_a_value_of_the_wrong_kind(self, said):
        assert said("9.8", "a") == "not yet: it is text where a number is expected"
        assert said("9.9", 3) == "not yet: it is the number 3 where text is expected"

    def test_asks_for_the_function_without_brackets(self, said):
        line = said("9.1", turn(np.zeros(3)))
        assert "no brackets" in line
        assert "you passed an array of shape (3, 3)" in line

    def test_asks_for_the_value_instead_of_a_function(self, said):
        assert "you passed a function" in said("9.8", four_thirds)

    def test_names_the_arguments_of_the_call(self, said):
        assert said("9.1", lambda q, machine: 0) == (
            "not yet: the function is called with (q), but yours takes (q, machine)"
        )
        assert "called with (a, b), but yours takes (v)" in said("9.3", stretch)

    def test_names_an_input_that_was_changed_although_the_numbers_are_right(self, said):
        def spoils(q):
            pose = turn(q)
            q[:] = 7.0
            return pose

        assert "changes its argument q in place" in said("9.1", spoils)

    def test_names_an_input_that_was_changed_beside_wrong_numbers(self, said):
        def spoils(q):
            q *= 3
            return turn(q) * 2

        assert said("9.1", spoils).endswith("it also changes q in place")

    def test_names_a_record_whose_part_was_changed(self, capsys):
        Pair = namedtuple("Pair", "first second")

        def spoils(pair):
            pair.second[0] = 7.0
            return 7.0

        exercise = Exercise(
            "9.60", "A record", seven, lambda rng: [(Pair(np.zeros(2), np.ones(2)),)] * 2
        )
        Check(SimpleNamespace(find=lambda number: exercise))("9.60", spoils)
        assert "changes its argument pair in place" in capsys.readouterr().out

    def test_one_changed_input_does_not_spoil_the_next(self, said):
        before = EXERCISES["9.1"].inputs()[0][0]
        said("9.1", lambda q: q.fill(0))
        assert np.array_equal(EXERCISES["9.1"].inputs()[0][0], before)

    def test_an_array_that_is_used_again_for_every_answer_counts_each_time(self, said):
        buffer = np.empty((3, 3))

        def reuses(q):
            buffer[:] = turn(q)
            return buffer

        assert said("9.1", reuses).startswith("right")


def test_a_constant_is_not_taken_for_an_answer_in_degrees():
    def whole_turns(angle):
        return float(np.ceil(angle / 100))

    exercise = Exercise(
        number="9.50",
        title="Turns",
        reference=whole_turns,
        cases=lambda rng: [(angle,) for angle in rng.uniform(150, 2000, 10)],
    )
    trial = ask(lambda angle: 1.0, prepare(exercise))
    assert diagnose(trial) == "it returns the same for every input"


class TestErrors:
    def test_names_the_error_and_the_line(self, said):
        def divides(q):
            return q / len(q[3:]) + 1 // 0

        line = said("9.1", divides)
        assert line.startswith("not yet: it stops with ZeroDivisionError: ")
        assert line.endswith("(in the line: return q / len(q[3:]) + 1 // 0)")

    def test_names_the_students_own_line_when_the_library_raises(self, said):
        def calls(q):
            return np.linalg.inv(np.zeros((3, 3)))

        assert said("9.1", calls).endswith("(in the line: return np.linalg.inv(np.zeros((3, 3))))")

    @pytest.mark.parametrize(
        "error",
        [
            SystemExit(1),
            KeyboardInterrupt(),
            GeneratorExit(),
            MemoryError(),
            StopIteration(),
            OwnBase("own"),
            EvilError(),
            ValueError("two\nlines"),
        ],
        ids=lambda error: type(error).__name__,
    )
    def test_survives_whatever_is_raised(self, said, error):
        assert said("9.1", raises(error)).startswith(
            f"not yet: it stops with {type(error).__name__}"
        )

    def test_survives_an_error_whose_text_ends_the_program(self, said):
        class Mute(Exception):
            def __str__(self):
                raise SystemExit

        assert said("9.1", raises(Mute())).startswith("not yet: it stops with Mute")

    def test_survives_a_function_that_ends_the_program_when_it_is_looked_at(self, said):
        class Shy:
            @property
            def __signature__(self):
                raise SystemExit

            def __call__(self, q):
                return turn(q)

        assert said("9.1", Shy()).startswith("right")

    def test_shows_no_control_characters(self, said):
        line = said("9.1", raises(ValueError("red \x1b[31m text")))
        assert line.isprintable() and "red [31m text" in line

    def test_names_endless_recursion(self, said):
        assert "RecursionError: it calls itself without end" in said("9.1", endless_recursion)

    @pytest.mark.parametrize("number", ["9.1", "9.4", "9.7", "9.8", "9.9", "9.10", "9.11"])
    def test_survives_evil_objects(self, said, number):
        assert said(number, Evil()).startswith("not yet: ")
        assert said(number, lambda q: Evil()).startswith("not yet: ")
        assert said(number, lambda q: [Evil(), Evil()]).startswith("not yet: ")

    def test_too_much_memory_is_an_error(self, said):
        assert "MemoryError" in said("9.1", lambda q: np.ones(10**15))


class TestTime:
    def test_an_endless_loop_is_stopped(self, said):
        def loops(q):
            while True:
                pass

        before = threading.active_count()
        assert said("9.11", loops) == ("not yet: no answer after 0.3 s; is there an endless loop?")
        assert threading.active_count() == before

    @pytest.mark.parametrize("caught", [Exception, BaseException])
    def test_an_endless_loop_that_swallows_errors_is_stopped(self, said, caught):
        def loops(q):
            while True:
                try:
                    q = q + 1
                except caught:
                    pass

        before = threading.active_count()
        assert said("9.11", loops).endswith("is there an endless loop?")
        assert threading.active_count() == before

    def test_a_check_gives_up_on_what_cannot_be_stopped(self, said):
        awake = threading.Event()

        def waits(q):
            awake.wait()
            return turn(q)

        line = said("9.11", waits)
        assert line.endswith("It cannot be stopped: restart the kernel")
        awake.set()

    def test_the_time_is_for_all_cases_together(self, said):
        def slow(q):
            time.sleep(0.05)
            return turn(q)

        assert "no answer after 0.3 s" in said("9.11", slow)

    def test_an_endless_conversion_is_stopped(self, said):
        class Endless:
            def __array__(self, *arguments, **keywords):
                while True:
                    pass

        assert "no answer after 0.3 s" in said("9.11", lambda q: Endless())

    def test_works_outside_the_main_thread(self, said):
        def loops(q):
            while True:
                pass

        lines = []
        thread = threading.Thread(target=lambda: lines.append(said("9.11", loops)))
        thread.start()
        thread.join()
        assert lines == ["not yet: no answer after 0.3 s; is there an endless loop?"]

    def test_a_real_interrupt_is_not_swallowed_and_stops_the_answer(self, ctrl_c):
        started, ended = threading.Event(), threading.Event()

        def loops():
            try:
                started.set()
                while True:
                    pass
            finally:
                ended.set()

        def interrupts():
            started.wait()
            _thread.interrupt_main()

        threading.Thread(target=interrupts).start()
        with pytest.raises(KeyboardInterrupt):
            guard.run(loops, 4.0)
        assert ended.wait(1.0)


class TestTraces:
    def test_prints_and_warnings_of_the_answer_are_not_shown(self, said, capsys):
        def chats(q):
            print("x" * 10_000)
            print("y", file=sys.stderr)
            warnings.warn("careful", stacklevel=1)
            return turn(q)

        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert said("9.1", chats) == "right (20 random poses)"
        assert capsys.readouterr().err == ""

    def test_printing_works_again_after_an_endless_loop(self, said, capsys):
        def loops(q):
            while True:
                print("again")

        said("9.11", loops)
        print("here")
        assert capsys.readouterr().out == "here\n"

    def test_the_random_state_is_left_alone(self, said):
        np.random.seed(3)  # noqa: NPY002
        wanted = np.random.random()  # noqa: NPY002
        np.random.seed(3)  # noqa: NPY002

        def seeds(q):
            np.random.seed(99)  # noqa: NPY002
            return turn(q)

        said("9.1", seeds)
        assert np.random.random() == wanted  # noqa: NPY002

    def test_the_same_answer_gets_the_same_line(self, said):
        assert said("9.2", np.sin) == said("9.2", np.sin)


class TestMemory:
    def test_hints_come_from_the_second_wrong_answer_on_and_in_stages(self, said, capsys):
        check, wrong = Check(OURS), lambda q: np.eye(3)
        printed = []
        for _ in range(6):
            check("9.1", wrong)
            printed.append(capsys.readouterr().out.splitlines()[1:])
        assert printed == [
            [],
            ["exercise 9.1: hint 1 of 2: first"],
            ["exercise 9.1: hint 2 of 2: second"],
            [
                "exercise 9.1: no further hints: read the section above it once more, or see "
                'check.solution("9.1")'
            ],
            [],
            [],
        ]

    def test_an_untouched_stub_gets_no_hint(self, said, capsys):
        check = Check(OURS)
        for _ in range(3):
            check("9.1", None)
            assert capsys.readouterr().out == "exercise 9.1: not done yet\n"

    def test_hints_can_be_asked_for(self, said, capsys):
        check = Check(OURS)
        check.hint("9.1")
        check.hint("9.1")
        check.hint("9.2")
        assert capsys.readouterr().out.splitlines() == [
            "exercise 9.1: hint 1 of 2: first",
            "exercise 9.1: hint 2 of 2: second",
            "exercise 9.2: no hints: read the section above it once more, or see "
            'check.solution("9.2")',
        ]

    def test_the_summary_lists_what_was_done(self, said, capsys):
        check = Check(OURS)
        check.summary()
        assert capsys.readouterr().out == "no exercise checked yet\n"
        check("9.1", turn)
        check("9.2", np.sin)
        check("9.3", None)
        capsys.readouterr()
        check.summary()
        lines = capsys.readouterr().out.splitlines()
        today = f"{datetime.now().day} {datetime.now():%b %Y}"
        assert lines[:5] == [
            "lesson 9: 1 of 12 right",
            f"  9.1   right         A pose (right {today}, try 1)",
            "  9.2   not yet       A vector",
            "  9.3   not done yet  Two arguments",
            "  9.4   not checked   Two values",
        ]

    def test_the_summary_shows_the_latest_answer(self, said, capsys):
        check = Check(OURS)
        check("9.1", turn)
        check("9.1", np.sin)
        capsys.readouterr()
        check.summary()
        assert "9.1   not yet       A pose (right " in capsys.readouterr().out


class TestSolution:
    def test_shows_the_source_and_where_it_lives(self, said, capsys):
        Check(OURS).solution("9.2")
        printed = capsys.readouterr().out
        assert printed.startswith(f"exercise 9.2: one solution, {__name__}.stretch:\n\n")
        assert printed.endswith("def stretch(v):\n    return 2 * v + 1\n")

    def test_shows_the_settings_of_a_function_that_takes_more(self, capsys):
        exercise = Exercise("9.61", "With b", partial(slope, b=2.0), lambda rng: [(1.0,)])
        Check(SimpleNamespace(find=lambda number: exercise)).solution("9.61")
        first = capsys.readouterr().out.splitlines()[0]
        assert first == f"exercise 9.61: one solution, {__name__}.slope, b=2.0:"

    def test_shows_a_value(self, said, capsys):
        Check(OURS).solution("9.9")
        assert capsys.readouterr().out == "exercise 9.9: the answer is 'boom'\n"

    @pytest.mark.parametrize("off", ["off", " OFF "])
    def test_a_teacher_can_turn_it_off(self, said, capsys, monkeypatch, off):
        monkeypatch.setenv("BACKHOE_SOLUTIONS", off)
        Check(OURS).solution("9.2")
        assert capsys.readouterr().out == (
            "exercise 9.2: your teacher has turned the solutions off\n"
        )


class TestRegistry:
    @pytest.mark.parametrize("number", ["0.99", "0.", "0"])
    def test_an_unknown_number_lists_those_of_the_lesson(self, number):
        with pytest.raises(ValueError, match=r"lesson 0 has 0\.1, 0\.2"):
            Check(catalogue)(number, None)

    @pytest.mark.parametrize("number", ["99.1", "x", ""])
    def test_an_unknown_lesson_lists_the_lessons(self, number):
        with pytest.raises(ValueError, match=r"exercises are numbered 0\.1, \.\.\."):
            Check(catalogue).hint(number)

    def test_a_number_must_be_text(self):
        with pytest.raises(ValueError, match=r'text, such as "1\.2", got 1\.2'):
            Check(catalogue).solution(1.2)

    def test_an_unknown_lesson_has_no_exercises(self):
        with pytest.raises(ValueError, match="no exercises for lesson '77'"):
            catalogue.lesson("77")


class TestWriting:
    def test_a_number_has_two_parts(self):
        with pytest.raises(ValueError, match="numbered like"):
            Exercise("one", "t", 1.0)

    def test_a_text_is_one_line(self):
        with pytest.raises(ValueError, match=r"every text of exercise 9\.1"):
            Exercise("9.1", "t", 1.0, hints=("two\nlines",))
        with pytest.raises(ValueError, match=r"every text of exercise 9\.1"):
            Exercise("9.1", "t", 1.0, mistakes={"": 2.0})

    def test_a_reference_has_a_name(self):
        with pytest.raises(ValueError, match="the reference is a lambda"):
            Exercise("9.1", "t", lambda q: q, vectors)

    def test_mistakes_of_a_function_are_functions(self):
        with pytest.raises(ValueError, match="must be functions"):
            Exercise(
                "9.1",
                "t",
                turn,
                vectors,
                mistakes={
                    "d": 3.0,
                },
            )

    def test_tolerances_are_not_negative(self):
        with pytest.raises(ValueError, match="rtol must be one number at least 0"):
            Exercise("9.1", "t", 1.0, rtol=-1.0)

    def test_cases_are_tuples(self):
        with pytest.raises(TypeError, match=r"a tuple of arguments such as \(q,\), got ndarray"):
            Exercise("9.1", "t", turn, lambda rng: [np.zeros(3)]).inputs()

    def test_there_are_cases(self):
        with pytest.raises(ValueError, match="no cases"):
            Exercise("9.1", "t", turn, lambda rng: []).inputs()

"""What the checks of lesson 03 say of answers that are nearly right."""

import numpy as np

from backhoe.arm import lyapunov
from backhoe.course import catalogue
from backhoe.course.checking import Check
from backhoe.lessons.lyapunov_pid.exercises.digital import digital_pid


def said(capsys, number, answer):
    Check(catalogue)(number, answer)
    return capsys.readouterr().out


def test_the_first_sample_that_differs_is_named(capsys):
    def stumbling(kp, ki, kd, dt, limit):
        right, count = digital_pid(kp, ki, kd, dt, limit), 0

        def step(*sample):
            nonlocal count
            count += 1
            return right(*sample) * (0.9 if count == 8 else 1.0)

        return step

    assert "sample 7, counted from 0" in said(capsys, "3.8", stumbling)


def test_a_minimum_for_a_maximum_is_not_called_an_angle(capsys):
    def smallest(postures):
        return min(np.linalg.norm(slope, 2) for slope in lyapunov.gravity_slope(postures))

    assert "whole turns" not in said(capsys, "3.4", smallest)

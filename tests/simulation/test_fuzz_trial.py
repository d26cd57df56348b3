"""Wrong input at a dig as a try: `fuzz` says what is tried and allowed."""

import numpy as np
import pytest

from backhoe.machine import BACKHOE
from backhoe.simulation import trial
from backhoe.simulation.scene import LOADING
from fuzz import assert_answers_or_names

PATH = np.linspace([5.5, -1.0, 1.5, 0.2], [5.6, -0.9, 1.6, 0.1], 5)
TIMES = np.linspace(0.0, 0.2, 5)
WORLD = {"scene": LOADING, "seed": 1, "soil": "loam", "machine": BACKHOE, "pose": np.zeros(3)}
TABLE = {
    trial.dig: {"path": PATH, "times": TIMES, **WORLD, "ground": None},
    trial.dig_many: {"paths": [PATH], "times": TIMES, "processes": 1, **WORLD},
}


@pytest.mark.parametrize("function", TABLE, ids=lambda function: function.__name__)
@pytest.mark.timeout(300)
def test_wrong_input_is_answered_or_refused_by_name(function):
    assert_answers_or_names(function, TABLE[function], {"paths": ("path",)}, slow=True)

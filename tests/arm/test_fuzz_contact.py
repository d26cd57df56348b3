"""Wrong input at what the joints feel of a push: `fuzz` says what is tried and allowed."""

import numpy as np
import pytest

from backhoe.arm import contact
from backhoe.machine import BACKHOE
from fuzz import assert_answers_or_names

Q = np.array([[0.1, 0.5, -1.5, 0.3], [0.0, 0.2, -1.0, 0.1]])
PUSHED = np.array([[100.0, 20.0, -300.0, 50.0], [10.0, 0.0, 30.0, -5.0]])
TABLE = {
    contact.contact_jacobian: {"q": Q, "machine": BACKHOE},
    contact.joint_torque: {"q": Q, "push": PUSHED, "machine": BACKHOE},
    contact.push_from: {"q": Q, "torque": PUSHED, "machine": BACKHOE},
}


@pytest.mark.parametrize("function", TABLE, ids=lambda function: function.__name__)
def test_wrong_input_is_answered_or_refused_by_name(function):
    assert_answers_or_names(function, TABLE[function], {"q": ("posture", "leading axes")})

"""Where each quantity of a block of closed loops lies in its one flat array.

A row holds one number for each run; row r of run j is at r * LANES + j. What joints have takes four
rows, swing, boom, stick, bucket.
"""

from __future__ import annotations

from itertools import count

LANES = 16
"""Runs in a block."""

ABREAST = 8
"""Rows are worked through in whole multiples of so many lanes; the last may be idle."""

_free = count()


def _rows(number: int) -> int:
    """The first of the next few rows."""
    return min(next(_free) for _ in range(number))


# What the arm carries from sample to sample: angles, speeds, torque, and the cosine and sine of the
# pitch of boom, stick and bucket.
Q, W, TAU, TURNS = _rows(4), _rows(4), _rows(4), _rows(6)
PAYLOAD = _rows(1)

# What the law sees and keeps.
Q_SEEN, W_SEEN = _rows(4), _rows(4)
INTEGRAL, RATE, LAST, WANTED = _rows(4), _rows(4), _rows(4), _rows(4)
KP, KI, KD = _rows(4), _rows(4), _rows(4)

# A Runge-Kutta step: its length, speeds and accelerations of the stage before, their weighted sums,
# how far the angles are ahead, torque less friction; and the first acceleration.
H, V, A = _rows(1), _rows(4), _rows(4)
SUM_V, SUM_A, SHIFT, NET, A_FIRST = _rows(4), _rows(4), _rows(4), _rows(4), _rows(4)

# To start a sample again: where it began, its first acceleration, and of which run in how many
# steps.
Q_KEPT, W_KEPT, A_KEPT = _rows(4), _rows(4), _rows(4)
LANE, STEPS = _rows(1), _rows(1)

ROWS = next(_free)
"""How many there are."""

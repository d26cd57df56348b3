"""Better by practice: searches that need only the cost of a try.

- `practice`: batches of tries around a mean, and what came of them
- `path_integral`: PI2, weights from the costs of one batch
- `returns`: PoWER, weights from rewards of the best tries so far
"""

from __future__ import annotations

from backhoe.planning.improve.path_integral import pi2, pi2_weights
from backhoe.planning.improve.practice import Learning
from backhoe.planning.improve.returns import power, power_weights

__all__ = ["Learning", "pi2", "pi2_weights", "power", "power_weights"]

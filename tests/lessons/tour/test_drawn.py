"""What the figures of the tour show is what they were given."""

import numpy as np

from backhoe.lessons.tour import figures
from drawn import Panel, line, proofs

T = np.array([0.0, 1.0, 3.0, 4.0])
BUCKET, TRUCK = np.array([0.0, 0.7, 0.1, 0.0]), np.array([0.0, 0.0, 0.6, 0.65])


TestDrawn = proofs(
    figures,
    {
        "soil": lambda: (
            figures.soil(T, BUCKET, TRUCK),
            [
                Panel(
                    "time [s]",
                    "volume of soil [m^3]",
                    [line(T, BUCKET, "in the bucket"), line(T, TRUCK, "in the truck")],
                )
            ],
        ),
    },
)

"""What the figures of lesson 04 show is what they were given."""

import numpy as np

from backhoe.lessons.skid_steer import figures
from backhoe.vehicle.skid_steer import HUSKY
from drawn import Panel, arrow, box, line, proofs, track, words

X, Y = "$x$ forward [m]", "$y$ to the left [m]"
TURN, SPIN = (0.5, -0.1, 1.0), (0.0, 0.0, 1.0)
FRONT, REAR, HALF = HUSKY.front, HUSKY.rear, HUSKY.half_track
CORNERS = [(FRONT, HALF), (FRONT, -HALF), (-REAR, HALF), (-REAR, -HALF)]


def body():
    a, b = HUSKY.wheel_radius, HUSKY.wheel_width / 2
    hull = box(-REAR, -0.62 * HALF, FRONT, 0.62 * HALF)
    return [hull, *(box(x - a, y - b, x + a, y + b) for x, y in CORNERS), line(0.0, 0.0)]


def slipped():
    """Each arrow from the speed of its contact point; those shorter than a centimetre are left."""
    panels = []
    for title, (v_x, v_y, omega), rims in (
        ("turn", TURN, None),
        ("spin", SPIN, (-0.5, 0.4)),
    ):
        items, centre = body(), np.array([-v_y, v_x]) / omega
        for k, (x, y) in enumerate(CORNERS):
            ground = np.array([v_x - omega * y, v_y + omega * x])
            along = np.array([ground[0] if rims is None else rims[k % 2], 0.0])
            start, rolled, moved = (np.add((x, y), 0.5 * way) for way in (0 * along, along, ground))
            for way in ((start, rolled), (rolled, moved), (start, moved)):
                items += [track(way), arrow(*way)]
            items.append(track([centre, (x, y)]))
        items.append(track([centre], "centre of rotation"))
        panels.append(Panel(X, Y, items, title))
    fig = figures.contacts({"turn": TURN, "spin": SPIN}, HUSKY, {"spin": (-0.5, 0.4)})
    named = [text.get_text() for text in fig.legends[0].get_texts()]
    assert named == ["rolls", "slips", "moves over the ground", "centre of rotation"]
    return fig, panels


def rubbed():
    speed = np.linspace(-1, 1, 20)
    laws = {"smooth": 0.2 * np.arctan(10 * speed), "linear": 2.0 * speed, "other": 0.1 * speed}
    fast = speed > 0
    ratio = 2.0 * speed[fast] / (0.2 * np.arctan(10 * speed[fast]))
    left = [line(speed, law, name) for name, law in laws.items()] + [box(-0.05, 0.0, 0.05, 1.0)]
    right = [line(speed[fast], ratio), box(0.0, 0.0, 0.05, 1.0)]
    right += [words("shaded: up to 50 mm/s", (1.3 * 0.05, 0.93 * ratio.max()))]
    return figures.friction_laws(laws, speed, 0.05), [
        Panel("sliding speed [m/s]", "friction over load [1]", left, clipped=True),
        Panel("sliding speed [m/s]", "linear over smooth [1]", right),
    ]


TestDrawn = proofs(figures, {"contacts": slipped, "friction_laws": rubbed})

"""What the figures of lesson 10c show is what they were given."""

import numpy as np
import pytest

from backhoe.lessons.primitives.figures import improvement as figures
from drawn import Panel, arrow, ellipse, line, proofs, track, tunnel


def weighed():
    tries = np.array([[0.3, -0.2], [-0.1, 0.4], [0.5, 0.6]])
    weights = {"soft": [0.25, 0.25, 0.5], "hard": [0.0, 0.19, 0.81]}
    panels = []
    for title, shares in weights.items():
        end = sum(share * place for share, place in zip(shares, tries, strict=True))
        circles = [
            ellipse(place, 0.5 * share**0.5, 0.5 * share**0.5)
            for share, place in zip(shares, tries, strict=True)
        ]
        items = [line(*tries.T, "tries"), *circles, line(0.4, 0.5, "cheapest"), arrow((0, 0), end)]
        panels.append(Panel(r"$\theta_1$ [1]", "" if panels else r"$\theta_2$ [1]", items, title))
    return figures.weighed(tries, weights, [0.4, 0.5]), panels


def curves():
    """By hand: medians and ends of the best so far of three seeds."""
    costs = {
        "one": [[5.0, 4.0, 6.0], [5.0, 7.0, 1.0], [5.0, np.inf, 3.0]],
        "other": [[5.0, 2.0, 9.0], [5.0, 3.0, 2.5], [5.0, 3.0, 1.5]],
    }
    count = [1, 2, 3]
    items = [
        line(count, [5, 5, 3], "one"),
        tunnel(count, [5, 4, 1], [5, 5, 4]),
        line(count, [5, 3, 2], "other"),
        tunnel(count, [5, 2, 1.5], [5, 3, 2.5]),
    ]
    return figures.curves(costs), [Panel("tries", "cost of the best so far [1]", items)]


def strokes():
    ground = np.array([[5.0, 0.0], [6.0, 0.7], [7.0, 1.1]])
    ways = {"shown": np.array([[6.5, 1.5], [6.0, 0.4], [5.0, 0.9]])}
    items = [track(ways["shown"], "shown"), tunnel(ground[:, 0], [-0.2] * 3, ground[:, 1])]
    return figures.strokes(ways, ground), [Panel("$x$ [m]", "$z$ [m]", items)]


TestDrawn = proofs(figures, {"weighed": weighed, "curves": curves, "strokes": strokes})


def test_figures_without_content_are_refused():
    with pytest.raises(ValueError, match="at least one panel"):
        figures.weighed([[0.0, 0.0]], {}, [0.0, 0.0])
    with pytest.raises(ValueError, match="at least one method"):
        figures.curves({})

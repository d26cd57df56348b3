"""Filters that estimate a state from a motion and measurements, and tests of what they claim.

- `linear`, `extended`, `unscented`, `particle`: four filters with one interface, predict and update
- `batch`: many extended filters at once
- `bayes`: the Bayes filter over finitely many states
- `equations`: gain, Joseph form, information form, discrete step, numerical Jacobian
- `history`, `smoother`: hindsight
- `consistency`: NEES, NIS, their bands, ellipses
- `observability`: what no measurement shows
- `least_squares`: the whole history in one system, to judge filters by
- `engine`: the compiled arithmetic of one filter or many

Source: Mastalli 2013, chapter 4.
"""

from __future__ import annotations

from backhoe.localisation.kalman.batch import BatchExtendedKalmanFilter
from backhoe.localisation.kalman.bayes import DiscreteBayesFilter
from backhoe.localisation.kalman.consistency import (
    chi_square_band,
    ellipse,
    nees,
    nis,
    share_inside,
)
from backhoe.localisation.kalman.equations import (
    gain,
    information_update,
    joseph,
    numerical_jacobian,
    short_form,
    transition,
    update,
)
from backhoe.localisation.kalman.extended import ExtendedKalmanFilter
from backhoe.localisation.kalman.history import History
from backhoe.localisation.kalman.least_squares import least_squares
from backhoe.localisation.kalman.linear import KalmanFilter
from backhoe.localisation.kalman.observability import unobservable
from backhoe.localisation.kalman.particle import ParticleFilter, systematic_resample
from backhoe.localisation.kalman.smoother import Smoothed, rts_smoother
from backhoe.localisation.kalman.unscented import UnscentedKalmanFilter

__all__ = [
    "BatchExtendedKalmanFilter",
    "DiscreteBayesFilter",
    "ExtendedKalmanFilter",
    "History",
    "KalmanFilter",
    "ParticleFilter",
    "Smoothed",
    "UnscentedKalmanFilter",
    "chi_square_band",
    "ellipse",
    "gain",
    "information_update",
    "joseph",
    "least_squares",
    "nees",
    "nis",
    "numerical_jacobian",
    "rts_smoother",
    "share_inside",
    "short_form",
    "systematic_resample",
    "transition",
    "unobservable",
    "update",
]

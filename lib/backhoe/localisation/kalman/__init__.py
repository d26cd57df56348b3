"""Filters that estimate a state from a motion and measurements, and tests of what they claim.

- `linear`, `extended`, `unscented`, `particle`: four filters with one interface, predict and update
- `batch`: many extended filters at once
- `bayes`: the Bayes filter over finitely many states
- `equations`: gain, Joseph form, information form, numerical Jacobian
- `discretise`: the discrete step of a continuous system
- `history`, `smoother`: hindsight
- `consistency`: NEES, NIS, their bands, whiteness, ellipses
- `observability`: what no measurement shows
- `least_squares`: the whole history in one system, to judge filters by

Source: Mastalli 2013, chapter 4.
"""

from __future__ import annotations

from backhoe.basics.angles import residual, wrap
from backhoe.localisation.kalman.batch import BatchExtendedKalmanFilter
from backhoe.localisation.kalman.bayes import DiscreteBayesFilter
from backhoe.localisation.kalman.consistency import (
    Whiteness,
    chi_square_band,
    ellipse,
    nees,
    nis,
    share_inside,
    whiteness,
)
from backhoe.localisation.kalman.discretise import discrete_noise, transition
from backhoe.localisation.kalman.equations import (
    gain,
    information_update,
    joseph,
    numerical_jacobian,
    short_form,
    update,
)
from backhoe.localisation.kalman.extended import ExtendedKalmanFilter
from backhoe.localisation.kalman.history import History
from backhoe.localisation.kalman.least_squares import least_squares
from backhoe.localisation.kalman.linear import KalmanFilter
from backhoe.localisation.kalman.observability import observability_matrix, unobservable
from backhoe.localisation.kalman.particle import ParticleFilter, systematic_resample
from backhoe.localisation.kalman.smoother import Smoothed, rts_smoother
from backhoe.localisation.kalman.unscented import UnscentedKalmanFilter, sigma_points

__all__ = [
    "BatchExtendedKalmanFilter",
    "DiscreteBayesFilter",
    "ExtendedKalmanFilter",
    "History",
    "KalmanFilter",
    "ParticleFilter",
    "Smoothed",
    "UnscentedKalmanFilter",
    "Whiteness",
    "chi_square_band",
    "discrete_noise",
    "ellipse",
    "gain",
    "information_update",
    "joseph",
    "least_squares",
    "nees",
    "nis",
    "numerical_jacobian",
    "observability_matrix",
    "residual",
    "rts_smoother",
    "share_inside",
    "short_form",
    "sigma_points",
    "systematic_resample",
    "transition",
    "unobservable",
    "update",
    "whiteness",
    "wrap",
]

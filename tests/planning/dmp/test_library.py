"""Primitives by name, in files, one after the other."""

from __future__ import annotations

import numpy as np
import pytest

from backhoe.planning.dmp import DMP, Library, demonstration, sequence


@pytest.fixture(scope="module")
def library():
    return Library(
        {
            name: DMP(kernels=60, formulation=form, spacing="time").learn(one.positions, one.times)
            for name, form in (("dig", "pastor"), ("load", "ijspeert"))
            for one in [demonstration(name)]
        }
    )


def test_files_keep_every_number(library, tmp_path):
    library.save(tmp_path / "mine")
    again = Library.load(tmp_path / "mine")
    assert list(again) == ["dig", "load"]
    for name in library:
        options = {"goal": library[name].goal + 0.1, "duration": 9.0, "remedy": "affine"}
        pairs = zip(library[name].rollout(**options), again[name].rollout(**options), strict=True)
        for old, new in pairs:
            assert (old == new).all()


def test_names_and_files_that_are_wrong_are_named(library, tmp_path):
    with pytest.raises(ValueError, match="primitive must be one of dig, load, got 'digg'"):
        library["digg"]
    with pytest.raises(ValueError, match="must hold primitives"):
        Library.load(tmp_path)
    library.save(tmp_path)
    file = tmp_path / "dig.json"
    file.write_text(file.read_text().replace('"tau": 6.0', '"tau": -6.0'))
    with pytest.raises(ValueError, match=r"dig\.json must be a primitive as save writes it: tau"):
        Library.load(tmp_path)
    with pytest.raises(ValueError, match="plain word"):
        Library({"../dig": library["dig"]})


@pytest.mark.parametrize("blend", [0.0, 1.5])
def test_a_sequence_is_continuous_in_position_and_velocity(library, blend):
    """Positions are the integral of the velocities, also where the second takes over."""
    dig, load = library["dig"], library["load"]
    t, x, v = sequence(
        [dig, load, dig],
        [None, None, dig.goal + 0.2],
        [12.0, 10, 14],
        dt=0.005,
        blend=blend,
        exact_end=True,
    )
    assert t[-1] == pytest.approx(36.0 - 2 * blend)
    summed = x[0] + np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(t)[:, None], axis=0)
    assert np.abs(summed - x[1:]).max() < 2e-3
    assert np.abs(x[-1] - (dig.goal + 0.2)).max() < 1e-9


def test_a_blend_joins_a_moving_end_with_less_acceleration(library):
    """The first is cut off in its swing; alone the second has to brake within its own 54 ms."""
    one = demonstration("load")
    cut = DMP(kernels=60).learn(one.positions[:500], one.times[:500])
    assert np.abs(cut.velocities[1]).max() > 0.3
    peaks = []
    for blend in (0.0, 1.0):
        t, _, v = sequence([cut, library["dig"]], blend=blend)
        near = np.abs(t - cut.duration) < 1.2
        peaks.append(np.abs(np.gradient(v, t, axis=0))[near].max())
    assert peaks[1] < peaks[0] / 2


def test_a_sequence_refuses_what_does_not_fit(library):
    with pytest.raises(ValueError, match="one or more"):
        sequence([])
    with pytest.raises(ValueError, match="one a primitive, 1, got 2 and 1"):
        sequence([library["dig"]], goals=[None, None])
    with pytest.raises(ValueError, match="blend must be shorter"):
        sequence([library["dig"], library["load"]], blend=12.0)
    with pytest.raises(TypeError, match="must be a DMP"):
        sequence(["dig"])

"""The sources' printed numbers load, and the machine uses those of Tables A.1 and A.2."""

import numpy as np
import pytest

from backhoe.lessons import published
from backhoe.machine import BACKHOE
from backhoe.machine.provenance import provenance


def test_a_missing_file_is_named_with_those_that_exist(tmp_path):
    (tmp_path / "there.toml").write_text('source = "a book"\n')
    with pytest.raises(FileNotFoundError, match=r"gone\.toml; there are: there"):
        published.load("gone", folder=tmp_path)


def test_an_empty_folder_is_said_to_be_empty(tmp_path):
    with pytest.raises(FileNotFoundError, match="full copy of the repository"):
        published.load("gone", folder=tmp_path)


@pytest.mark.parametrize("name", published.names())
def test_every_file_says_which_source_it_copies(name):
    assert "201" in published.load(name)["source"] or "202" in published.load(name)["source"]


def test_the_machine_has_every_printed_value_of_table_a2():
    table = published.load("mastalli_2013_table_a2")
    printed = table["lengths"] | table["masses"] | table["inertias"]
    used = {symbol.replace("L0", "L_0"): value for _, value, symbol, _, _ in provenance()}
    used = {symbol: used.get(symbol, used.get(symbol.replace("_", ""))) for symbol in printed}
    assert used == pytest.approx(printed)


def test_the_machine_takes_the_sizes_of_the_printed_angles_and_chooses_the_signs():
    angles = published.load("mastalli_2013_table_a2")["angles_deg"]
    signs = {
        "theta_2": BACKHOE.boom.angle_offset,
        "theta_cm2": BACKHOE.boom.com_angle,
        "theta_3": -BACKHOE.stick.angle_offset,
        "theta_cm3": -BACKHOE.stick.com_angle,
        "theta_4": -BACKHOE.bucket.angle_offset,
        "theta_cm4": -BACKHOE.bucket.com_angle,
    }
    assert {name: np.degrees(value) for name, value in signs.items()} == pytest.approx(angles)


def test_the_free_fall_cases_differ_from_case_1_in_one_torque_each():
    cases = published.load("mastalli_2013_free_fall")
    first = np.array(cases["case_1"]["torque"])
    for name, joint in (("case_2", 0), ("case_3", 1)):
        assert np.flatnonzero(np.array(cases[name]["torque"]) != first).tolist() == [joint]

"""What is stored of missions that nobody watched is what the machine does today."""

import pytest

from backhoe.mission import autonomy
from mission.autonomy.write_unattended import row

ROWS = autonomy.unattended()
SEEDS = [one for one in ROWS if not one["fault"]]
FAULTS = [one for one in ROWS if one["fault"]]


def test_ten_missions_hit_nothing_stay_upright_and_lose_nothing():
    assert [one["seed"] for one in SEEDS] == list(range(10))
    for one in SEEDS:
        assert one["loads"] == 3 and not one["stopped"], one["ended"]
        assert one["clearance"] > 0.1 and one["margin"] > 0.1
        assert one["into_truck"] >= 0.9


def test_each_fault_ends_with_all_buckets_or_with_a_safe_stop_and_its_reason():
    assert [one["fault"] for one in FAULTS] == list(autonomy.FAULTS)
    for one in FAULTS:
        assert one["clearance"] > 0 and one["margin"] > 0.1
        assert (one["loads"] == 2) != bool(one["stopped"]), one["ended"]
        assert one["ended"]


@pytest.mark.parametrize("fault, seed", [("gyro reversed", 0), ("", 8)])
def test_a_mission_of_today_gives_its_stored_row(fault, seed):
    stored = next(one for one in ROWS if (one["fault"], one["seed"]) == (fault, seed))
    today = row(fault, seed)
    for name, value in stored.items():
        if isinstance(value, float):
            assert float(today[name]) == pytest.approx(value, abs=0.02, rel=0.02, nan_ok=True)
        else:
            assert today[name] == value

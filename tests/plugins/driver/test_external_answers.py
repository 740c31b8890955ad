"""Odd answers of an external driver are its faults; motion that no vehicle can make is never taken."""

import pytest

from plugins.driver.external import External
from sgcad_core.errors import SimulationFailed
from sgcad_core.handover.drive import drive
from sgcad_core.handover.script import staging_for
from tests.sgcad_core.handover.scenes import rear_end

HERE = "tests.plugins.driver.test_external_answers"
SAY = {}


def says(message):
    return SAY["answer"](message["view"]["ego"]) if "view" in message else {}


def told(answer):
    SAY["answer"] = answer
    return drive(staging_for(rear_end(own=15.0), "V1"), External(target=f"{HERE}:says"))


@pytest.mark.parametrize(
    "answer",
    [
        [], "text", "trajectory", None, 3, True, {}, {"acceleration_mps2": "1"}, {"acceleration_mps2": 10**5000},
        {"acceleration_mps2": float("nan")}, {"acceleration_mps2": True},
        {"acceleration_mps2": 0.0, "steering_rad": []},
        {"trajectory": []}, {"trajectory": 3}, {"trajectory": [[0.0, 0.0]]},
        {"trajectory": [[0.0, 1e300, 0.0, 0.0, 0.0]]},
        {"trajectory": [[0.0] * 5] * 3000}, {"trajectory": [[0.0, 10**400, 0.0, 0.0, 0.0]]},
    ],
)  # fmt: skip
def test_an_odd_answer_is_the_drivers_fault(answer):
    with pytest.raises(SimulationFailed, match="the external driver answered"):
        told(lambda ego: answer)


@pytest.mark.parametrize(
    ("east", "north", "turned", "faster"),
    [
        (500.0, 0.0, 0.0, 0.0),
        (0.75, 4.0, 0.0, 0.0),
        (0.75, 0.0, 3.0, 0.0),
        (0.0, 0.0, 0.0, -15.0),
        (0.0, 0.0, 0.0, 0.0),
    ],
)
def test_motion_beyond_the_vehicles_limits_is_a_fault(east, north, turned, faster):
    def jump(ego):
        row = [ego["x_m"] + east, ego["y_m"] + north, ego["heading_rad"] + turned, ego["speed_mps"] + faster]
        return {"trajectory": [[0.05, *row]]}

    with pytest.raises(SimulationFailed, match="impossible motion"):
        told(jump)


def test_a_braking_trajectory_within_the_limits_is_driven():
    def brake(ego):
        speed = max(0.0, ego["speed_mps"] - 5.0 * 0.05)
        return {"trajectory": [[0.05, ego["x_m"] + (speed + ego["speed_mps"]) / 2 * 0.05, ego["y_m"], 0.0, speed]]}

    assert told(brake).contact is None

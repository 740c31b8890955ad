"""Accounts inside printed forms, laid out as public forms are: the reading is that of the account alone."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read

MANUFACTURER = """REPORT OF TRAFFIC COLLISION INVOLVING AN AUTONOMOUS VEHICLE
OL 316 (REV. 2/2017)
INSTRUCTIONS: Please print within the spaces and boxes on this form. Use a second sheet where the space is short.
SECTION 1 - MANUFACTURER'S INFORMATION
MANUFACTURER'S NAME: Acme Robotics   AVT NUMBER: AVT-000
SECTION 2 - ACCIDENT INFORMATION/VEHICLE 1
VEHICLE YEAR: 2021  MAKE: Jaguar  MODEL: I-Pace
Vehicle was: [X] Moving [ ] Stopped in Traffic   Involved in the Accident: [ ] Pedestrian [ ] Bicyclist [ ] Other
SECTION 3 - OTHER PARTY'S INFORMATION/VEHICLE 2
Vehicle was: [X] Moving [ ] Stopped in Traffic
SECTION 5 - ACCIDENT DETAILS - DESCRIPTION
[X] Autonomous Mode [ ] Conventional Mode
{account}
MOVEMENT PRECEDING COLLISION: [ ] A. STOPPED [X] B. PROCEEDING STRAIGHT [ ] E. MAKING LEFT TURN [ ] H. BACKING
TYPE OF COLLISION: [X] A. HEAD-ON [ ] B. SIDE SWIPE [ ] C. REAR END [ ] G. VEHICLE/PEDESTRIAN
I certify under penalty of perjury under the laws of the state that the foregoing is true and correct.
"""
POLICE = """CRASH REPORT                                  PAGE 1 OF 2
☐ Fatal ☐ Injury ☑ Property damage only ☐ Hit and run
UNIT 1: DRIVER LAST NAME ____ FIRST NAME ____ VEHICLE 1 YEAR 2016
UNIT 2: DRIVER LAST NAME ____ FIRST NAME ____ VEHICLE 2 YEAR 2012
LIGHT: ☑ Daylight ☐ Dark   SURFACE: ☑ Dry ☐ Wet ☐ Ice
VEHICLE ACTION: ☐ Backing ☑ Going straight ☐ Turning left ☐ Parked
NARRATIVE: {account}
OFFICER SIGNATURE ____  BADGE ____
"""
INSURER = """CLAIM NOTICE (REV. 11/2019)
[ ] Glass [X] Collision [ ] Theft
POLICY NO. 000-000
INSURED VEHICLE: VEHICLE 1   OTHER VEHICLE: VEHICLE 2   PEDESTRIAN INJURED? [ ] Yes [X] No
DESCRIBE WHAT HAPPENED:
{account}
NOTE: any person who knowingly presents a false claim for the payment of a loss is guilty of a crime.
SIGNATURE ____
"""
TABLE = """SECTION 1
Unit | Type | Damage
VEHICLE 1 | PASSENGER CAR | FRONT
VEHICLE 2 | TRUCK | REAR
SECTION 2
[X] Intersection [ ] Driveway [ ] Parking lot
SECTION 3
{account}
SECTION 4
WITNESSES: NONE
"""
LAYOUTS = {"manufacturer": MANUFACTURER, "police": POLICE, "insurer": INSURER, "table": TABLE}
ACCOUNTS = {
    "struck from behind": "An Acme autonomous vehicle was stopped at a red light when a passenger car approached from "
    "behind and the front of the passenger car made contact with the rear of the Acme AV.",
    "cut in on": "The Acme AV was traveling north on Oak Street. A van in the adjacent left lane changed lanes to the "
    "right and the right side of the van made contact with the left side of the Acme AV.",
    "numbered": "Vehicle 1 was traveling north on Oak Street. Vehicle 2 was traveling east on Elm and ran the red "
    "light. The front of Vehicle 2 struck the left side of Vehicle 1.",
    "on foot": "The Acme AV was traveling east on Mill Lane when a pedestrian stepped off the curb and was hit by "
    "the front of the Acme AV.",
    "backed into": "The Acme AV was parked at the curb. A truck in front of it began to reverse, and the rear of the "
    "truck made contact with the front of the parked Acme AV.",
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("account", ACCOUNTS)
def test_of_a_form_the_account_alone_is_read(layout: str, account: str) -> None:
    alone, filled = read(ACCOUNTS[account]), read(LAYOUTS[layout].format(account=ACCOUNTS[account]))
    assert filled.crash.gap is None
    assert filled.crash == alone.crash
    assert filled.roads.junction.kind == alone.roads.junction.kind


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_form_without_an_account_is_refused_as_such(layout: str) -> None:
    gap = read(LAYOUTS[layout].format(account="")).crash.gap
    assert gap is not None
    assert "no account" in gap.reason


def test_facts_of_a_form_have_their_places_in_the_whole_text() -> None:
    text = MANUFACTURER.format(account=ACCOUNTS["cut in on"])
    reading = read(text)
    assert reading.narrative == text
    spans = [text[f.start : f.end] for f in reading.facts if f.field == "vehicles.V2.maneuver" and f.start is not None]
    assert any("changed lanes" in span for span in spans)


def test_a_report_with_one_bracket_is_no_form() -> None:
    text = "[X] was dark. V1 struck V2 in the rear."
    assert [v.id for v in read(text).crash.vehicles] == ["V1", "V2"]

"""Outcomes of drives in a study's tables."""

from flows.results.measures import _driven

OUTCOMES = {"avoided": 1, "mitigated": 0, "unchanged": 0, "worse": 0, "lost": 0, "failed": 0}


def test_one_driver_an_arm_has_its_outcomes_by_role():
    found = dict(_driven({"aeb": {"initiator": OUTCOMES}}))
    assert found == {
        "d_initiator_avoided": 1,
        "d_initiator_mitigated": 0,
        "d_initiator_worse": 0,
        "d_initiator_lost": 0,
    }


def test_drives_that_failed_and_arms_of_several_drivers_are_left_out():
    assert dict(_driven({"aeb": {"initiator": OUTCOMES | {"failed": 1}}})) == {}
    assert dict(_driven({"aeb": {"initiator": OUTCOMES}, "idm": {"initiator": OUTCOMES}})) == {}


def test_the_table_counts_avoided_and_mitigated_by_role(tables):
    made = tables({"a": {"c1": {}, "c2": {}}})
    table = next(t for t in made.tables if t.key == "driven")
    cells = table.rows[0].cells
    assert (cells["d_initiator_avoided"].value, cells["d_initiator_avoided"].n) == (100.0, 2)
    assert cells["d_responder_mitigated"].value == 100.0

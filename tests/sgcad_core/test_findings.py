"""Findings: one maker for every source, and the line that a prompt shows."""

from sgcad_core.findings import FindingFactory, Hold


def test_a_finder_names_its_source_and_fills_in_what_a_finding_leaves_out():
    found = FindingFactory("agreement", where="road network", remedy="write it anew")
    usual, own = (
        found("a lane lies elsewhere", value=0.4),
        found("no lane", "legs[0]", remedy="add one", severity="note"),
    )
    assert usual.line() == "[agreement] a lane lies elsewhere at road network (found 0.4) -> write it anew"
    assert own.line() == "[agreement] no lane at legs[0] -> add one"
    assert (usual.severity, own.severity, own.holds) == ("repair", "note", ())


def test_holds_of_a_finding_stay_with_it():
    hold = Hold(items="legs", at=1, either=({"bearing": ("N", "E")},))
    assert FindingFactory("layout")("two legs have one bearing", "legs", holds=(hold,)).holds == (hold,)
    assert hold.line() == "legs[1]: bearing N/E"

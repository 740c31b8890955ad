"""What is told when another simulator plays a scenario otherwise than ours."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.case.records import Execution, ObservedContact, RoadNetwork, Scenario
from sgcad_core.errors import SimulationFailed
from sgcad_core.execution.compare_executions import Judgement, compared, judge
from sgcad_core.interfaces import Simulator
from sgcad_core.records.specs import Contact
from tests.sgcad_core.formats.xosc_samples import actor, trajectory

K = np.arange(40)
DECLARED = Contact(striker="V1", struck="V2", striker_area="front", struck_area="back")
HIT = ObservedContact(actor="V1", other="V2", actor_area="front", other_area="back", t_s=1.0)


def execution(shift=0.0, steps=40, contact=HIT, complaints=()):
    motions = (trajectory("V1", K * 0.5, 0)), trajectory("V2", K * 0.0 + 20, shift * (K == 30))
    cut = tuple(m.model_copy(update={n: getattr(m, n)[:steps] for n in COLUMNS}) for m in motions)
    return Execution(simulator="s", trajectories=cut, contact=contact, complaints=complaints)


COLUMNS = ("t_s", "x_m", "y_m", "heading_rad", "speed_mps")


def test_agreement_says_nothing():
    verdict = compared("other", execution(), execution(), DECLARED)
    assert verdict.lines() == []
    assert (verdict.loaded, verdict.same_motion, verdict.as_declared) == (True, True, True)


@pytest.mark.parametrize(
    ("theirs", "line"),
    [
        (execution(shift=0.3), "other: V2 at 1.50 s is 0.300 m beside our playing (limit 0.01 m)"),
        (execution(steps=20), "other: ends 1.00 s before our playing"),
        (execution(contact=None), "other: the first contact is not the declared one, but none"),
        (execution(complaints=("[error] x",)), "other: [error] x"),
    ],
    ids=["elsewhere", "short", "no contact", "complaint"],
)
def test_every_disagreement_is_told(theirs, line):
    verdict = compared("other", execution(), theirs, DECLARED)
    assert verdict.lines() == [line]
    assert not (verdict.loaded and verdict.same_motion and verdict.as_declared)
    assert Judgement.model_validate({k: verdict.summary()[k] for k in Judgement.model_fields}) == verdict


def test_an_undeclared_contact_is_nobodys_disagreement():
    assert compared("other", execution(), execution(contact=None), None).lines() == []


def test_a_judge_that_fails_has_judged():
    class Dying(Simulator):
        def execute(self, scenario, network):
            raise SimulationFailed("it died")

    scenario = Scenario(xosc="<x/>", actors=(actor("V1"), actor("V2")), declared=DECLARED)
    verdict = judge(Dying(), execution(), scenario, RoadNetwork())
    assert verdict.lines() == ["dying: did not run: it died"]
    assert verdict.summary()["loaded"] is False

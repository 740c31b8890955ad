"""A model's own acts in the account: another one than the rules read is a disagreement, an open one lacks."""

from types import SimpleNamespace

import pytest

from sgcad_core.account.records import Item
from sgcad_core.account.second_opinion import weighed
from sgcad_core.records.acts import Acts, Rest
from sgcad_core.records.specs import Actor, BehaviorSpec


def made(acts):
    actor = Actor(id="V1", kind="car", road="S", direction="forward", maneuver="straight", acts=acts)
    return SimpleNamespace(told={}, tracks={}, scenario=SimpleNamespace(behavior=BehaviorSpec(actors=(actor,))))


def lack(field, value):
    return Item(kind="lacks", field=f"vehicles.V1.{field}", subject="V1", value=value, text=field)


@pytest.mark.parametrize(
    ("field", "read_as", "acts", "own"),
    [("rest.facing_deg", 90.0, Acts(rest=Rest(facing_deg=180)), 180.0),
     ("spin", "clockwise", Acts(spin="counterclockwise"), "counterclockwise"),
     ("evasion.brakes", True, Acts(evasion="none"), "none"), ("from_stop", True, Acts(from_rest=False), False)],
)  # fmt: skip
def test_another_act_than_the_rules_read_is_a_second_opinion(field, read_as, acts, own):
    items, differing = weighed(made(acts), [lack(field, read_as)], (), ("scenario",))
    assert items == []
    assert [(one.field, one.kept, one.other) for one in differing] == [(f"vehicles.V1.{field}", own, read_as)]


@pytest.mark.parametrize("acts", [None, Acts(), Acts(spin="clockwise")])
def test_what_the_model_leaves_open_lacks(acts):
    told = [lack("rest.facing_deg", 90.0)]
    assert weighed(made(acts), told, (), ("scenario",)) == (told, [])


def test_without_a_model_the_text_counts():
    told = [lack("rest.facing_deg", 90.0)]
    assert weighed(made(Acts(rest=Rest(facing_deg=180))), told, (), ()) == (told, [])

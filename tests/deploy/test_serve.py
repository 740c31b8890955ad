"""The automation for dead runs: of Prefect's own form, and left alone where it is as it should be."""

import yaml
from prefect.events.schemas.automations import AutomationCore

from deploy import serve, services

WANTED = yaml.safe_load(services.DEAD_RUNS.read_text())


def test_the_automation_has_prefects_form_and_outlasts_two_heartbeats_of_every_run_that_it_watches():
    made = AutomationCore.model_validate(WANTED)
    assert made.actions[0].state == "CRASHED"
    for deployment in yaml.safe_load(services.DEPLOYMENTS.read_text())["deployments"]:
        beat = deployment["work_pool"]["job_variables"]["env"]["PREFECT_FLOWS_HEARTBEAT_FREQUENCY"]
        assert made.trigger.within.total_seconds() > 2 * int(beat)
        assert f"prefect.tag.{deployment['tags'][0]}" == WANTED["trigger"]["match_related"]["prefect.resource.id"]


def test_an_automation_as_it_should_be_is_left_and_another_is_not():
    found = AutomationCore.model_validate(WANTED).model_dump(mode="json") | {"id": "1"}
    assert serve._holds(found, WANTED)
    assert not serve._holds(found, WANTED | {"enabled": False})
    other = WANTED | {"trigger": WANTED["trigger"] | {"within": 300}}
    assert not serve._holds(found, other)

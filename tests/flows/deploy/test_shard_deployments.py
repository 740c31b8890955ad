"""The shard deployments as deploy/prefect.yaml defines them."""

import inspect

import pytest
import yaml

from sgcad_core import settings

RUN = "00000000-0000-0000-0000-000000000001"
DEPLOYMENTS = {
    one["name"]: one for one in yaml.safe_load((settings.ROOT / "deploy" / "prefect.yaml").read_text())["deployments"]
}


@pytest.mark.parametrize("name", ["shard", "shard-gpu"])
def test_a_shard_deployment_serves_the_flow_and_gives_it_parameters_that_it_has(name):
    from flows.deploy.shards import DEPLOYMENT, shard_flow

    assert DEPLOYMENTS[name]["entrypoint"] == f"{shard_flow.fn.__module__}.{shard_flow.fn.__name__}"
    assert set(DEPLOYMENTS[name].get("parameters", {})) <= set(inspect.signature(shard_flow.fn).parameters)
    assert DEPLOYMENT.split("/")[0] == shard_flow.name


def test_a_card_holds_one_model_whose_batch_serves_many_cases():
    gpu = DEPLOYMENTS["shard-gpu"]
    assert gpu["concurrency_limit"] == {"limit": 1, "collision_strategy": "ENQUEUE"}
    assert gpu["work_pool"]["work_queue_name"] == "gpu" != DEPLOYMENTS["shard"]["work_pool"].get("work_queue_name")
    assert gpu["parameters"]["jobs"] > 1


def test_a_flow_run_has_a_thread_for_every_case_of_the_batch():
    from flows.deploy.shards import THREADS, shard_flow

    assert shard_flow.task_runner._max_workers == THREADS >= DEPLOYMENTS["shard-gpu"]["parameters"]["jobs"]


def test_a_server_that_is_gone_is_waited_for_whichever_way_prefect_says_so():
    """Opening a client raises RuntimeError, a request httpx's errors: both mean try again."""
    from prefect.settings import PREFECT_API_URL, PREFECT_CLIENT_MAX_RETRIES, temporary_settings

    from flows.deploy.shards import PrefectPool
    from flows.study.shared_storage import Unreachable

    pool = PrefectPool("s", {})
    with temporary_settings({PREFECT_API_URL: "http://127.0.0.1:9/api", PREFECT_CLIENT_MAX_RETRIES: 0}):
        for act in (lambda: pool.states([RUN]), lambda: pool.submit(0), lambda: pool.give_up(RUN, "gone")):
            with pytest.raises(Unreachable, match="server does not answer"):
                act()

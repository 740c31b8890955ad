"""Results, arms and runs that the tests of the MLflow tracker share."""

from sgcad_core.case.tracker_arm import Arm, Dataset

RESULT = {
    "status": "generated",
    "attempts": {"road": 2, "scenario": 1},
    "collision": {"declared": {"striker": "V1"}, "observed": {"t_s": 4.2}, "realised": True},
    "seconds": {"read": 0.1, "road": 1.4},
}
REFUSED = {"status": "refused", "seconds": {"read": 0.1}, "collision": {"realised": False}}
PARAMS = {"seed": 42, "decoder": {"name": "cad", "alpha": 0.7}, "validators": [{"name": "topology"}]}


def arm(out, **changes):
    dataset = Dataset(name="cases", digest="ab" * 32, source="/cases", cases=4)
    plugins = {"decoder": "plugins.decoder.cad:Cad 1", "retriever": "plugins.retriever.lancedb:LanceDB 1 kb-v1-aa"}
    fields = {"config": "kit", "params": PARAMS, "out": str(out), "dataset": dataset, "plugins": plugins}
    fields |= {"git_commit": "c0ffee", "hardware": {"processor": "a CPU", "cores": 2, "gpus": []}}
    return Arm(**fields | changes)


def runs_of(tracker, text=""):
    """(client, parents, children by case), found by a search as a person would write it."""
    store = tracker._store(None)
    runs = store.client.search_runs([store.experiment_id], text, order_by=["attributes.start_time ASC"])
    parents = [r for r in runs if "mlflow.parentRunId" not in r.data.tags]
    return store.client, parents, {r.info.run_name: r for r in runs if "mlflow.parentRunId" in r.data.tags}


def log(tracker, out, case, result=RESULT):
    tracker.log_case("kit", PARAMS, out / "kit" / case, result)

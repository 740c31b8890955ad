"""Results folders for the desk: made from the bundled reports once a session, copied for those that change them."""

import json
import re
import shutil

import httpx
import pytest
from starlette.testclient import TestClient

from flows.batch.config_folder import write
from flows.batch.plan_batch import batch_of
from flows.case.run_case import run_case
from flows.case_files.find_cases import cases_in
from flows.desk.app import application
from sgcad_core import settings

EVIL = '</script><script>document.title="owned"</script><img src=x onerror=alert(1)> {{ 7*7 }} "\'&'


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    """Reports and results of the bundled demo under the template config, without Prefect."""
    folder = tmp_path_factory.mktemp("desk")
    shutil.copytree(settings.ROOT / "docs" / "demo", folder / "reports")
    batch = batch_of(
        cases_in([folder / "reports"]), [settings.CONFIGS / "template.yaml"], folder / "runs", ["tracker=none"]
    )
    for job in batch.plan():
        write(batch.out / job.config.name, job.config)
        run_case(job.config, job.case, batch.out, job.digest)
    return folder


@pytest.fixture
def runs(made, tmp_path):
    """A copy of the results, with reports of their own, that a test may change; the config's folder is `kit`."""
    shutil.copytree(made, tmp_path / "desk")
    return tmp_path / "desk" / "runs"


@pytest.fixture
def config(runs):
    """The config's folder in the results folder."""
    return next(f.parent for f in runs.glob("*/config.yaml"))


@pytest.fixture
def client(runs):
    with TestClient(application(runs), base_url="http://localhost") as client:
        yield client


class Page:
    """A case's page as a visitor has it: what it shows, and the change that its script would ask for."""

    def __init__(self, client: httpx.Client, key: str) -> None:
        self.client, self.key = client, key
        answer = client.get(f"/case/{key}")
        self.status, self.text = answer.status_code, answer.text
        self.token = self._found(r'name="desk-token" content="(\w+)"')
        self.version, self.stamp = self._found(r'data-version="(\w*)"'), self._found(r'data-stamp="(\w*)"')

    def _found(self, pattern):
        found = re.search(pattern, self.text)
        return found[1] if found else ""

    def change(self, kind="edit", headers=None, **edits):
        asked = {"version": self.version, "stamp": self.stamp, "who": "ann", "edits": edits}
        return self.client.post(
            f"/{kind}/{self.key}", json=asked, headers={"x-desk-token": self.token} | (headers or {})
        )


@pytest.fixture
def page(client):
    return lambda key: Page(client, key)


def foreign(folder, name, **changes):
    """A case as another program, or another version, may leave it: result.json alone."""
    place = folder / name
    place.mkdir(parents=True)
    result = {"case": name, "config": folder.name, "status": "generated", "reason": "", "facts": [], "notes": []}
    (place / "result.json").write_text(json.dumps(result | changes))
    return place

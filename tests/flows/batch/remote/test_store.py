"""Where a cluster's results are kept, and which of them are taken."""

import json
import pickle

import pytest
from prefect.filesystems import LocalFileSystem, RemoteFileSystem

from flows.batch.kept_results import KeptRecords, own_record
from flows.batch.plan_batch import batch_of
from flows.batch.remote import store
from flows.case.steps import Held
from flows.case_files.find_cases import cases_in
from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool


def test_a_file_address_is_a_folder(tmp_path):
    assert store.save(f"file://{tmp_path}/kept") == tmp_path / "kept"
    assert store.storage(str(tmp_path)) == tmp_path


def test_an_address_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(MissingTool, match=r"--store .*: cannot be written"):
        store.save(f"file://{tmp_path}/file/kept")


@pytest.fixture(params=["folder", "address"])
def block(request, tmp_path):
    """A storage of Prefect's: a local folder, or a file system by address."""
    if request.param == "folder":
        return LocalFileSystem(basepath=str(tmp_path))
    return RemoteFileSystem(basepath=f"memory://{tmp_path.name}")


def kept(serializer, content):
    """A kept result as Prefect writes it."""
    return json.dumps({"metadata": {"serializer": {"type": serializer}}, "result": content.decode()}).encode()


def test_a_result_of_ours_stays(block):
    block.write_path("key", kept("sgcad-records", KeptRecords().dumps(Held(b"packed"))))
    own_record(block, "key")
    assert store.read(block, "key")


@pytest.mark.parametrize("content", [kept("pickle", b"gA=="), pickle.dumps("x"), b'{"metadata": {'])
def test_a_result_that_would_be_unpickled_or_is_not_whole_is_removed(block, content):
    block.write_path("key", content)
    own_record(block, "key")
    assert store.read(block, "key") is None
    own_record(block, "key")


def test_a_cluster_needs_what_its_machines_share(reports, config_file, tmp_path, monkeypatch):
    batch = batch_of(cases_in([reports(c1="")]), [config_file()], tmp_path / "out")
    monkeypatch.setattr(settings, "prefect_url", lambda: "")
    assert batch.shown("stage", "dask").store == str(tmp_path / "out" / ".store")
    with pytest.raises(ConfigError, match="--store s3://b: give --workers"):
        batch.shown("stage", "auto", "s3://b")
    with pytest.raises(ConfigError, match="tcp://hub:8786: give --store"):
        batch.shown("stage", "tcp://hub:8786")
    with pytest.raises(MissingTool, match="a Prefect server is needed"):
        batch.shown("stage", "tcp://hub:8786", "s3://b")

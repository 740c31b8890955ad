"""What is sent with a case, what a worker refuses, and what is unpacked of its answer."""

import io
import tarfile
from dataclasses import replace

import pytest

from flows.batch.plan_batch import batch_of
from flows.batch.remote import sent_case
from flows.case import person_facts
from flows.case.steps import Held
from flows.case_files import find_cases
from sgcad_core.errors import ConfigError


@pytest.fixture
def job(reports, config_file, tmp_path):
    """The one job of a batch, and its order."""
    batch = batch_of(find_cases.cases_in([reports(c1="")]), [config_file()], tmp_path / "out")
    (job,) = batch.plan()
    return job, batch.order(job)


def test_a_report_is_the_same_where_it_is_sent_to(job, tmp_path):
    made, order = job
    (made.case.source / "more").mkdir()
    (made.case.source / "more" / "diagram.png").write_bytes(b"\x89PNG")
    sent = sent_case.sent(order, find_cases.config_digest(made.config))
    arrived = sent_case._unpacked(sent, tmp_path / "elsewhere")
    assert find_cases.source_digest(arrived.case.source) == find_cases.source_digest(made.case.source)
    assert str(tmp_path) not in repr(sent.order.case)


def test_a_report_that_is_a_file_takes_its_facts_along(job, tmp_path):
    _, order = job
    report = tmp_path / "alone.txt"
    report.write_text("The crash occurred in daylight.")
    report.with_name("alone.txt.facts.yaml").write_text("facts: []")
    sent = sent_case.sent(replace(order, case=find_cases.Case(report, "alone")), "")
    arrived = sent_case._unpacked(sent, tmp_path / "elsewhere")
    assert find_cases.source_digest(arrived.case.source) == find_cases.source_digest(report)


@pytest.mark.parametrize(
    ("spoil", "sendable"),
    [
        (lambda folder: None, True),
        (lambda folder: (folder / "out.txt").symlink_to("/etc/hostname"), False),
        (lambda folder: (folder / "large.txt").open("wb").truncate(60_000_000), False),
    ],
)
def test_only_a_report_of_plain_files_is_sent(job, spoil, sendable):
    spoil(job[0].case.source)
    assert sent_case.can_be_sent(job[0].case.source) is sendable


def test_a_machine_that_would_compute_another_result_refuses(job):
    _, order = job
    with pytest.raises(ConfigError, match=r"kit/c1: a worker would compute another result .* install the same version"):
        sent_case.run_sent(Held(sent_case.sent(order, "0" * 64)))


def packed(**files):
    """An archive of files by name."""
    packet = io.BytesIO()
    with tarfile.open(fileobj=packet, mode="w:gz") as archive:
        for name, content in files.items():
            about = tarfile.TarInfo(name)
            about.size = len(content)
            archive.addfile(about, io.BytesIO(content))
    return packet.getvalue()


def test_an_answer_becomes_the_folder_of_the_case(job):
    made, _ = job
    ending = sent_case.receive(made, packed(**{"result.json": b'{"status": "generated"}', ".digest": b"d"}))
    assert ending.result == {"status": "generated"}
    assert person_facts.report_path(made.folder.path) == made.case.source.resolve()


@pytest.mark.parametrize("content", [packed(**{"../../evil": b"x"}), b"no archive"])
def test_an_answer_that_is_no_folder_leaves_nothing(job, content):
    made, _ = job
    with pytest.raises(ConfigError, match="cannot be written"):
        sent_case.receive(made, content)
    assert not made.folder.path.exists()
    assert not list(made.folder.out.parent.rglob("evil"))

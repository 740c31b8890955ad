"""`sgcad drive` and the stage `drive`: files, reuse, tables, errors."""

import json
import math

import pytest
from typer.testing import CliRunner

from flows.case_files import case_folder
from flows.cli import app
from flows.drive import table
from flows.drive.run_drive import Order, drive_folders, first_page
from flows.drive.script_of_case import case_folders, roles_of
from sgcad_core.config import build, driver_entry
from sgcad_core.errors import BadInput, ConfigError
from sgcad_core.metrics.statistics import wilson
from tests.sgcad_core.handover.scenes import crossing

NET = (
    '<net version="1.20"><location netOffset="0,0" convBoundary="0,0,1,1" origBoundary="0,0,1,1" projParameter="!"/>'
    '<edge id="A" from="a" to="b" priority="-1"><lane id="A_0" index="0" speed="13.9" length="400" '
    'shape="-200,0 200,0"/></edge><junction id="a" type="dead_end" x="-200" y="0" incLanes="" intLanes="" shape=""/>'
    '<junction id="b" type="dead_end" x="200" y="0" incLanes="A_0" intLanes="" shape=""/></net>'
)


@pytest.fixture
def case(tmp_path):
    return written(tmp_path / "runs" / "kit" / "case-1")


def written(folder, made=None):
    made = made or crossing()
    folder.mkdir(parents=True)
    case_folder.write_trajectories(folder / "trajectories.csv", made.trajectories)
    (folder / "road.net.xml").write_text(NET)
    facts = [{"field": f"vehicles.{a}.role", "value": r} for a, r in made.roles.items()]
    result = {
        "case": folder.name, "status": "generated", "actors": [a.model_dump() for a in made.actors], "facts": facts,
        "collision": {"declared": made.declared.model_dump()},
    }  # fmt: skip
    case_folder.write_json(folder / "result.json", result)
    return folder


def driven(*arguments):
    return list(drive_folders(*arguments))


def run(*arguments):
    return CliRunner().invoke(app, ["drive", *map(str, arguments)])


def test_a_case_is_driven_in_both_roles_and_its_script_left_alone(case):
    before = {f.name: f.read_bytes() for f in case.iterdir() if f.is_file()}
    ended = run(case, "-d", "reference", "-d", "script")
    assert ended.exit_code == 0, ended.output
    assert {f.name: f.read_bytes() for f in case.iterdir() if f.is_file()} == before
    assert ended.output.splitlines()[-1] == f"look at: {case}/drive/reference/V1/drive.html"
    found = sorted(str(f.relative_to(case)) for f in case.rglob("drive.json"))
    assert found == [f"drive/{d}/{v}/drive.json" for d in ("reference", "script") for v in ("V1", "V2")]
    told = json.loads((case / "drive/script/V1/drive.json").read_text())
    assert (told["role"], told["outcome"], told["as_declared"]) == ("responder", "unchanged", True)
    assert len(told["series"]["t_s"]) == len(told["series"]["time_to_collision_s"])
    rows = case_folder.read_trajectories(case / "drive/script/V1/trajectories.csv")
    assert [t.actor for t in rows] == ["V1", "V2"]


LIMIT = '<param key="speed_limit" value="posted_mph 20"/></edge>'


def test_rules_are_told_with_the_outcome(case, tmp_path):
    net = (case / "road.net.xml").read_text().replace("</edge>", LIMIT)
    (case / "road.net.xml").write_text(net)
    file = tmp_path / "drives.csv"
    ended = run(case, "-d", "script", "--ego", "V1", "--csv", file)
    assert ended.exit_code == 0, ended.output
    assert "exceeded the speed limit 1" in ended.output
    told = json.loads((case / "drive/script/V1/drive.json").read_text())["rules"]
    found = next(f for f in told if f["rule"] == "speed_limit" and f["actor"] == "V1")
    assert (found["status"], found["measured"], found["limit"]) == ("broken", pytest.approx(10.0, abs=0.05), 8.941)
    assert file.read_text().splitlines()[1].endswith(",speed_limit")
    assert "V1 exceeded the speed limit" in (case / "drive/script/V1/drive.html").read_text()
    (case / "road.net.xml").write_text(net.replace("posted_mph 20", "assumed"))
    run(case, "-d", "script", "--ego", "V1")
    told = json.loads((case / "drive/script/V1/drive.json").read_text())["rules"]
    assert {f["status"] for f in told if f["rule"] == "speed_limit"} == {"unknown"}


def test_the_page_holds_script_and_drive(case):
    run(case, "--ego", "V1")
    page = (case / "drive/reference/V1/drive.html").read_text()
    assert all(name in page for name in ('"name":"script"', '"over":"script"', '"V1"', "drives V1, the responder"))


def test_what_is_driven_is_not_driven_again_until_something_changes(case):
    order = Order((driver_entry("reference"),), pages=False)
    driven([case], order, 1)
    file = case / "drive/reference/V1/drive.json"
    first = file.stat().st_mtime_ns
    driven([case], order, 1)
    assert file.stat().st_mtime_ns == first
    assert first_page([case], order) is None
    driven(
        [case], Order((driver_entry({"name": "reference", "model": "fuzzy", "label": "reference"}),), pages=False), 1
    )
    assert file.stat().st_mtime_ns != first


def test_a_person_has_the_last_word_on_roles(case):
    ended = run(case, "--role", "responder", "--role-of", "V1=initiator", "--role-of", "V2=responder")
    assert ended.exit_code == 0
    assert (case / "drive/reference/V2").is_dir()
    assert not (case / "drive/reference/V1").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--role", "bad"], "--role bad: no such role; roles: initiator, responder, bystander, both"),
        (["--role-of", "V1"], "--role-of V1: write ACTOR=ROLE"),
        (["--role-of", "V1=guilty"], "role V1=guilty: no such role"),
        (["-d", "nobody"], "unknown driver 'nobody'"),
        (["-d", "{name: aeb, ttc_s: -1}"], "greater than 0"),
        (["-d", "{name: aeb"], "no YAML"),
        (["--ego", "V7"], "no actor 'V7'"),
    ],
)
def test_faults_are_named_before_anything_is_driven(case, arguments, message):
    ended = run(case, *arguments)
    assert ended.exit_code != 0
    assert message in str(ended.exception) + ended.output
    assert not (case / "drive").exists()


def test_a_folder_without_cases_is_bad_input(tmp_path):
    with pytest.raises(BadInput, match="no executed case"):
        case_folders([tmp_path])


def test_the_table_counts_by_driver_and_role_with_wilsons_interval(tmp_path):
    for k in range(3):
        written(tmp_path / "runs" / f"case-{k}", crossing(own=8.0 + 4 * k))
    told = driven(case_folders([tmp_path]), Order((driver_entry("script"), driver_entry("aeb")), pages=False), 1)
    found = {(r["driver"], r["role"]): r for r in table.rows(told)}
    assert found["script", "initiator"]["unchanged"] == 3
    assert found["script", "responder"]["as_declared"] == 3
    assert sum(found["aeb", "responder"][o] for o in ("avoided", "mitigated", "unchanged", "worse", "lost")) == 3
    low, high = found["script", "initiator"]["avoided_low"], found["script", "initiator"]["avoided_high"]
    assert (low, high) == pytest.approx((0.0, 0.5615), abs=1e-3)
    file = tmp_path / "drives.csv"
    with file.open("w", newline="") as out:
        assert len(list(table.as_csv(out, told))) == 12
    assert len(file.read_text().splitlines()) == 1 + 12


def test_wilsons_interval_is_the_published_one():
    """Wilson's own formula at 5 of 10 and 0 of 10."""
    assert wilson(5, 10) == pytest.approx((0.2366, 0.7634), abs=1e-4)
    assert wilson(0, 10) == pytest.approx((0.0, 0.2775), abs=1e-4)
    assert wilson(10, 10)[1] == 1.0


def test_a_failing_driver_is_told_and_the_others_go_on(case):
    ended = run(case, "-d", "{name: external, target: 'no.such:thing'}", "-d", "script", "--role", "responder")
    assert ended.exit_code == 1
    assert "cannot be imported" in ended.output
    assert (case / "drive/script/V1/drive.json").is_file()


def test_a_config_may_name_drivers_one_or_many():
    raw = {
        "report_reader": "text", "retriever": "none", "road_writer": "template", "scenario_writer": "rules",
        "simulator": "kinematic", "tracker": "none",
    }  # fmt: skip
    one = build(raw | {"drive": "reference"}, "kit", "kit.yaml").drive
    assert [e.label for e in one.drivers] == ["reference"]
    many = {"drivers": ["idm", {"name": "aeb", "ttc_s": 2.0}], "roles": ["responder"], "role_of": {"V1": "responder"}}
    stage = build(raw | {"drive": many}, "kit", "kit.yaml").drive
    assert [e.label for e in stage.drivers] == ["idm", "aeb-2.0"]
    with pytest.raises(ConfigError, match=r"drive\.drivers\[0\]: unknown driver 'nobody'"):
        build(raw | {"drive": "nobody"}, "kit", "kit.yaml")
    with pytest.raises(ConfigError, match=r"drive\.roles\.0"):
        build(raw | {"drive": {"drivers": "idm", "roles": ["guilty"]}}, "kit", "kit.yaml")


def test_roles_are_read_from_the_facts():
    facts = [{"field": "vehicles.V1.role", "value": "initiator"}, {"field": "vehicles.V1.kind", "value": "car"}]
    assert roles_of(facts, {"V2": "responder"}) == {"V1": "initiator", "V2": "responder"}


def test_what_a_drive_took_is_told(case):
    told = driven([case], Order((driver_entry("idm"),), pages=False), 1)
    assert all(0 < t["seconds"] < math.inf for t in told)


@pytest.mark.slow
def test_cases_may_be_driven_side_by_side_with_the_same_results(tmp_path):
    for k in range(3):
        written(tmp_path / "runs" / f"case-{k}", crossing(own=8.0 + 4 * k))
    order = Order((driver_entry("aeb"),), pages=False, fresh=True)
    folders = case_folders([tmp_path])
    alone, together = (driven(folders, order, jobs) for jobs in (1, 2))
    assert [{**t, "seconds": 0} for t in alone] == [{**t, "seconds": 0} for t in together]


def test_copies_that_a_tracker_keeps_are_not_driven(tmp_path):
    written(tmp_path / "runs" / "kit" / "case-1")
    written(tmp_path / "runs" / "mlflow-artifacts" / "1" / "run" / "artifacts")
    assert [f.name for f in case_folders([tmp_path / "runs"])] == ["case-1"]

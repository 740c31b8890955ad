"""`sgcad revise` and `sgcad desk export` as they are typed: exit codes, one message, help."""

import pytest


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["revise", "nowhere"], "give one of --set FIELD=VALUE"),
        (["revise", "nowhere", "--set", "x"], "expected FIELD=VALUE"),
        (["revise", "nowhere", "--set", "near_crash=true"], "give the folder of a finished case"),
        (
            ["revise", "nowhere", "--undo", "--list"],
            "give one of --set FIELD=VALUE (several are allowed), --undo or --list",
        ),
        (["revise", "nowhere", "--later", "--set", "near_crash=true"], "the report is gone"),
        (["desk", "export", "nowhere", "--out", "x"], "give the folder of one config"),
    ],
)
def test_what_cannot_be_done_is_one_message_and_exit_code_2(here, words, said):
    done = here(*words)
    assert done.returncode == 2
    assert said in done.stderr
    assert done.stderr.startswith("sgcad: error: ")
    assert done.stdout == ""


def test_facts_kept_for_later_lie_beside_the_report(here, tmp_path):
    (tmp_path / "report.txt").write_text("V1 struck V2 from behind on a road, as the officer who came by said.")
    done = here("revise", tmp_path, "--later", "--set", "V1.maneuver=turn_left", "--why", "he said so", "--who", "ann")
    assert (done.returncode, done.stdout) == (0, f"kept for the next run: 1 facts of {tmp_path.name}\n")
    kept = (tmp_path / "facts.yaml").read_text()
    assert "field: vehicles.V1.maneuver" in kept
    assert "why: he said so" in kept

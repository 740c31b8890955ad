"""Files below a folder of runs are found once."""

from research.benchmarks.written_files import COPIES, written_files


def test_every_file_is_found_but_not_the_copy_of_a_tracker(tmp_path):
    runs = tmp_path / COPIES / "runs"  # a folder of that name above is no reason
    for place in ("b/case", "a/case", "a/case/export/traffic", f"{COPIES}/1/run/artifacts", f"a/{COPIES}/1"):
        (runs / place).mkdir(parents=True)
        (runs / place / "road.xodr").write_text("")
    found = [str(file.parent.relative_to(runs)) for file in written_files(runs, "road.xodr")]
    assert found == ["a/case/export/traffic", "a/case", "b/case"]

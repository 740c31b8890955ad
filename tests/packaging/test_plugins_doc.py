"""docs/plugins.md works as written: its files are written, its commands are run."""

import re
import shlex

import pytest

from tests.packaging.conftest import ROOT

PAGE = (ROOT / "docs" / "plugins.md").read_text()
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"\A# (\S+\.(?:py|toml|yaml))\n")


@pytest.mark.slow
def test_the_page_installs_and_runs(environment, tmp_path):
    blocks = BLOCK.findall(PAGE)
    for _, text in blocks:
        if named := FILE.match(text):
            file = tmp_path / named[1]
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
    (tmp_path / "report.txt").write_text((ROOT / "docs" / "demo" / "rear-end-on-arterial" / "report.txt").read_text())
    ran = []
    for language, text in blocks:
        for line in text.splitlines() if language == "sh" else ():
            words = shlex.split(line, comments=True)
            if words[:2] == ["pip", "install"]:
                environment.install(tmp_path / words[-1], cwd=tmp_path)
            else:
                done = environment.run(words[0], *words[1:], cwd=tmp_path)
                assert done.returncode == 0, (line, done.stdout, done.stderr)
            ran.append(words[:3])
    assert ["sgcad", "plugins", "new"] in ran
    assert ["sgcad", "run", "report.txt"] in ran
    assert (tmp_path / "runs" / "narrow" / "report" / "player.html").is_file()


def test_the_table_names_every_built_in_plugin():
    from sgcad_core.entry_points import KINDS, catalogue

    for kind in KINDS:
        row = next(line for line in PAGE.splitlines() if line.startswith(f"| {kind} |"))
        own = {name for name, point in catalogue(kind).items() if point.value.startswith("plugins.")}
        assert own == set(re.split(r",\s*", row.split("|")[3].strip())), kind

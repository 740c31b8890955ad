"""Every module that is a command explains itself, and imports nothing that is not installed to do so."""

import importlib
import re

import pytest

from sgcad_core.settings import ROOT

COMMAND = re.compile(r'^if __name__ == "__main__":', re.MULTILINE)
OWN_ENVIRONMENT = {
    f"research.checks.{name}" for name in ("asam_checkers", "commonroad_reader", "dsl_reader", "scenarionet_reader")
}
"""Run in environments of their own: that of `make qc`, and those of other tools' readers."""
COMMANDS = sorted(
    name
    for file in (ROOT / "research").rglob("*.py")
    if file.name == "__main__.py" or COMMAND.search(file.read_text(encoding="utf-8"))
    if (name := ".".join(file.relative_to(ROOT).with_suffix("").parts)) not in OWN_ENVIRONMENT
)


def test_packages_are_commands_as_well_as_modules():
    assert {"research.benchmarks.faults.__main__", "research.training.train"} <= set(COMMANDS)


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_explains_itself(name, capsys):
    with pytest.raises(SystemExit) as ended:
        importlib.import_module(name).main(["--help"])
    assert ended.value.code == 0
    shown = capsys.readouterr().out
    assert shown.startswith("usage: ")
    assert len(shown.splitlines()) > 4

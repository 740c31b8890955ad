"""How many OpenSCENARIO DSL files scenario_runner's grammar reads without a word against them.

    python -m venv ENV && ENV/bin/pip install antlr4-python3-runtime==4.10
    PYTHONPATH=SCENARIO_RUNNER ENV/bin/python research/checks/dsl_reader.py RUNS/template/*/export/dsl/*.osc

SCENARIO_RUNNER: a checkout of CARLA's scenario_runner. In an environment of its own, for its parser asks for this old
runtime. The grammar checks the order of words, not what they mean. Prints what fails, then one line of figures.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path


def main(files: Sequence[str]) -> int:
    """Read the files; 1 where one fails."""
    from antlr4 import CommonTokenStream, FileStream
    from antlr4.error.ErrorListener import ErrorListener
    from srunner.osc2.osc2_parser.OpenSCENARIO2Lexer import OpenSCENARIO2Lexer
    from srunner.osc2.osc2_parser.OpenSCENARIO2Parser import OpenSCENARIO2Parser

    class Faults(ErrorListener):  # type: ignore[misc]
        """What the lexer and the parser complain of."""

        def __init__(self) -> None:
            self.said: list[str] = []

        def syntaxError(self, recognizer, symbol, line, column, msg, e):  # type: ignore[no-untyped-def]
            """Keep a complaint."""
            self.said.append(f"line {line}: {msg}")

    good = 0
    for name in files:
        faults = Faults()
        lexer = OpenSCENARIO2Lexer(FileStream(name, encoding="utf-8"))
        parser = OpenSCENARIO2Parser(CommonTokenStream(lexer))
        for part in (lexer, parser):
            part.removeErrorListeners()
            part.addErrorListener(faults)
        told = parser.osc_file().getChildCount()
        good += not faults.said and told > 1
        if faults.said:
            sys.stdout.write(f"{Path(name).name}: {'; '.join(faults.said[:3])}\n")
    sys.stdout.write(f"files {len(files)}; read {good}\n")
    return int(good < len(files))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

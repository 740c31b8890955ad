"""A person's facts and a case's results change together, also where the process is killed between both.

.facts.yaml.journal lies beside the facts while they and the results are written: the facts as they were, the folder of
the results and its version. Who finds one without a living writer takes the facts back if the results were not
replaced; if they were, both are there. Knows no edit.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import Timeout

from flows.case_files.case_version import version_of
from sgcad_core.errors import BadInput, ConfigError
from sgcad_core.revision.file import MOST_BYTES, facts_lock, replace_text
from sgcad_core.system.report_files import JOURNAL, facts_file, read_regular


def journal_of(facts: Path) -> Path:
    """The journal of a facts.yaml."""
    return facts.with_name(f".{facts.name}{JOURNAL}")


@contextmanager
def both_or_neither(facts: Path, folder: Path) -> Iterator[None]:
    """The block writes facts, then results into `folder`: afterwards both are written, or the facts are as they were.

    The caller holds the facts' lock. Raises ConfigError: the report's folder cannot be written.
    """
    journal = journal_of(facts)
    before = read_regular(facts, most=MOST_BYTES).decode("utf-8") if facts.is_file() else None
    about = {"folder": str(folder), "version": version_of(folder), "facts": before}
    try:
        replace_text(journal, json.dumps(about))
    except OSError as fault:
        raise ConfigError(
            f"{journal}: cannot be written ({fault.strerror}); make the report's folder writable"
        ) from fault
    try:
        yield
    except BaseException:
        settle(facts)
        raise
    journal.unlink(missing_ok=True)


def settle(facts: Path) -> bool:
    """End what a killed writer has left; whether facts were taken back. The caller holds the facts' lock."""
    journal = journal_of(facts)
    try:
        about = json.loads(read_regular(journal, most=2 * MOST_BYTES))
        undone = bool(version_of(Path(about["folder"])) == about["version"])
        before = about["facts"]
    except (BadInput, ValueError, KeyError, TypeError, RecursionError):  # there is none, or it is of no use
        undone, before = False, None
    if undone and before is None:
        facts.unlink(missing_ok=True)
    elif undone:
        replace_text(facts, before)
    journal.unlink(missing_ok=True)
    return undone


def settled(source: Path) -> None:
    """End what a killed writer has left beside a report, unless another process is at work on its facts."""
    facts = facts_file(source)
    if journal_of(facts).is_file():
        with suppress(Timeout, BadInput, ConfigError, OSError), facts_lock(source, timeout_s=0):
            settle(facts)

"""facts.yaml beside a report: edits with author, time and reason. A strict, small file, replaced as a whole.

    for: 3f6c...           # fingerprint of the narrative that it was written for
    edits:
    - {field: roads.N.lanes_forward, value: 2, who: ann, when: '2026-11-24T13:45:00Z', why: the drawing shows two}

Edits stand in the order in which they were made; a later one of a field takes the earlier one's place. Knows the file
system; no case and no config.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import yaml
from filelock import Timeout
from pydantic import ValidationError

from sgcad_core.errors import BadInput, ConfigError, WrongEdit
from sgcad_core.records.edits import AS_READ, Edit
from sgcad_core.revision.fields import parsed_edit
from sgcad_core.system.locks import lock_file
from sgcad_core.system.report_files import JOURNAL, LOCK, facts_file, is_regular, read_regular
from sgcad_core.system.yaml_faults import YAML_FAULTS

MOST_BYTES = 1_000_000
MOST_EDITS = 2_000
_KEYS = ("for", "edits")
_TEXTS = ("report.txt", "narrative.txt")
_HEAD = "# What people know better than the reading of this report, written by `sgcad revise`; see docs/mending.md.\n"


def report_digest(source: Path) -> str:
    """Fingerprint of a report's text, white space apart: other pictures or codes are the same report.

    Raises BadInput where the report is gone or cannot be read.
    """
    files = _texts(source) if source.is_dir() else [source]
    if not files:
        raise BadInput(f"{source}: no report in it: put report.txt back, or run another case folder")
    found = hashlib.sha256()
    for file in files:
        found.update(b" ".join(read_regular(file, source if source.is_dir() else None).split()) + b"\n")
    return found.hexdigest()[:16]


def _texts(folder: Path) -> list[Path]:
    """The narrative's file; without one, the files that hold it."""
    files = sorted(f for f in folder.iterdir() if is_regular(f))
    named = [f for name in _TEXTS for f in files if f.name.lower() == name]
    return named[:1] or [f for f in files if f.suffix.lower() in (".txt", ".xml", ".pdf")]


def read_edits(path: Path, digest: str = "") -> tuple[Edit, ...]:
    """The edits of a facts.yaml; () where there is none. Raises BadInput naming file, value and remedy.

    `digest`: that of the report it lies beside; a file that was written for another one is refused.
    """
    if not path.is_file():
        return ()
    try:
        raw = yaml.safe_load(read_regular(path, most=MOST_BYTES).decode("utf-8"))
    except YAML_FAULTS as fault:
        raise BadInput(f"{path}: no YAML: {fault}; mend it, or remove it to go by the reading alone") from fault
    rows = _rows(path, raw)
    meant = str(raw.get("for") or "") if isinstance(raw, dict) else ""
    if digest and meant and meant != digest:
        raise BadInput(f"{path}: was written for another report (for: {meant}; the report beside it is {digest}): "
                       f"if it still holds, look it through and set `for: {digest}`; else remove it")  # fmt: skip
    return tuple(_edit(path, number, row) for number, row in enumerate(rows))


def _rows(path: Path, raw: Any) -> list[Any]:
    if not isinstance(raw, dict) or not isinstance(raw.get("edits"), list):
        raise BadInput(f"{path}: expected a mapping with a list `edits`; see docs/mending.md, or remove the file")
    if unknown := [str(key) for key in raw if key not in _KEYS]:
        raise BadInput(f"{path}: unknown key {unknown[0]!r}: use {' and '.join(_KEYS)}")
    if len(raw["edits"]) > MOST_EDITS:
        raise BadInput(f"{path}: {len(raw['edits'])} edits, at most {MOST_EDITS} are read: remove some")
    return list(raw["edits"])


def _edit(path: Path, number: int, row: Any) -> Edit:
    at = f"{path}: edits[{number}]"
    if not isinstance(row, dict) or "field" not in row or "value" not in row:
        raise BadInput(f"{at}: {row!r} is no edit: give field and value, and who, when and why")
    try:
        name, value = parsed_edit(str(row["field"]), row["value"])
        return Edit.model_validate({**row, "field": name, "value": value})
    except WrongEdit as fault:
        raise BadInput(f"{at}: {fault}") from fault
    except ValidationError as fault:
        error = fault.errors()[0]
        place = ".".join(str(part) for part in error["loc"])
        raise BadInput(f"{at}.{place}: {error['msg']} (found {error.get('input')!r}): correct it") from fault


def write_edits(path: Path, edits: Sequence[Edit], digest: str = "") -> None:
    """Write the file whole or not at all; without edits there is none. Raises ConfigError: it cannot be written."""
    try:
        if not edits:
            path.unlink(missing_ok=True)
            return
        replace_text(path, _text(edits, digest))
    except OSError as fault:
        raise _unwritable(path, fault) from fault


def replace_text(path: Path, text: str) -> None:
    """Write a file beside a report whole, on the disk before it has its name. Raises OSError: it cannot be written."""
    made, partial = tempfile.mkstemp(prefix=f".{path.name.lstrip('.')}.", suffix=JOURNAL, dir=path.parent)
    try:
        with os.fdopen(made, "w", encoding="utf-8") as out:
            out.write(text)
            out.flush()
            os.fsync(out.fileno())
        Path(partial).chmod(0o640)
        os.replace(partial, path)
    except BaseException:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(partial)
        raise


def _unwritable(path: Path, fault: OSError) -> ConfigError:
    return ConfigError(f"{path}: cannot be written ({fault.strerror}); make the report's folder writable")


def _text(edits: Sequence[Edit], digest: str) -> str:
    rows = [{k: v for k, v in _row(edit).items() if v != "" or k == "value"} for edit in edits]
    content = ({"for": digest} if digest else {}) | {"edits": rows}
    return _HEAD + str(yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120))


def _row(edit: Edit) -> dict[str, Any]:
    value = list(edit.value) if isinstance(edit.value, tuple) else edit.value
    when = edit.when.isoformat().replace("+00:00", "Z")
    return {"field": edit.field, "value": value, "who": edit.who, "when": when, "why": edit.why}


def with_new_edits(before: Sequence[Edit], new: Sequence[Edit]) -> tuple[Edit, ...]:
    """The history with new edits behind; those that change nothing are left out."""
    found = list(before)
    for edit in new:
        last = next((e.value for e in reversed(found) if e.field == edit.field), AS_READ)
        if (type(last), last) != (type(edit.value), edit.value):
            found.append(edit)
    return tuple(found)


def without_last_edits(edits: Sequence[Edit]) -> tuple[Edit, ...]:
    """The history without what was given last: all edits of that moment."""
    return tuple(e for e in edits if e.when != edits[-1].when) if edits else ()


@contextmanager
def facts_lock(source: Path, timeout_s: float = -1) -> Iterator[None]:
    """Keeps other processes from changing the facts of this report during the block; the next one waits.

    Raises filelock.Timeout where `timeout_s` (-1: no limit) is over, BadInput where the report is gone, ConfigError
    where its folder cannot be written.
    """
    file = facts_file(source)
    with contextlib.ExitStack() as held:
        try:
            source.stat()
            held.enter_context(lock_file(file.with_name(f".{file.name}{LOCK}"), timeout_s))
        except Timeout:
            raise
        except PermissionError as fault:
            raise _unwritable(file, fault) from fault
        except OSError as fault:
            gone = f"{source}: the report is gone ({fault.strerror}): put it back, or name it with --report"
            raise BadInput(gone) from fault
        yield

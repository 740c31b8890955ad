"""The reports that a command names, the names of their folders, and the digest by which a case counts as finished.

Reads a report's content only for the digest.
"""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path

from flows.case_files.folder_cases import SUFFIXES, inside
from sgcad_core import settings
from sgcad_core.config import Config
from sgcad_core.errors import BadInput, ConfigError
from sgcad_core.foreign_plugins import code_fingerprint
from sgcad_core.interfaces import Plugin
from sgcad_core.records.second_reader import LEARNED, NUMBERED_WEIGHTS, WEIGHTS, WHOLE
from sgcad_core.system.digest import file_sha256
from sgcad_core.system.report_files import MAX_FILE_BYTES, facts_file, files_below, is_regular

CODE = {".py", ".yaml"}
MAX_NAME_BYTES = 120
"""Of a case's folder name: room for a suffix within the file systems' 255."""
MAX_READ_BYTES = 300 * 2**20


@dataclass(frozen=True)
class Case:
    """One report and the name of its folder in the output."""

    source: Path
    id: str


def cases_of(sources: Sequence[Path]) -> tuple[Case, ...]:
    """Reports named one by one. Raises ConfigError for a missing one or two of the same name."""
    missing = [str(s) for s in sources if not _is_there(s)]
    if missing:
        raise ConfigError(f"no such report: {', '.join(missing)}; give a case folder or a .txt, .xml or .pdf file")
    cases = tuple(Case(s, name) for s, name in zip(sources, _names(sources), strict=True))
    twice = [name for name, n in Counter(c.id.casefold() for c in cases).items() if n > 1]
    if twice:
        same = [str(c.source) for c in cases if c.id.casefold() == twice[0]]
        raise ConfigError(f"{' and '.join(same)} would share the folder {twice[0]!r}: rename one or use another --out")
    return cases


def _is_there(source: Path) -> bool:
    """Whether it exists; a path that cannot be looked at counts as existing and fails as a case of its own."""
    try:
        return source.exists()
    except PermissionError:
        return True


def _names(sources: Sequence[Path]) -> list[str]:
    """Folder names: a file's name without its suffix, unless two reports of the batch would share it."""
    plain = [_name(source, whole=False) for source in sources]
    count = Counter(name.casefold() for name in plain)
    return [_name(source, whole=count[name.casefold()] > 1) for source, name in zip(sources, plain, strict=True)]


def _name(source: Path, *, whole: bool) -> str:
    place = source.resolve()
    suffixed = source.is_file() and place.suffix.lower() in {*SUFFIXES, ".md"}
    return safe_id(place.stem if suffixed and not whole else place.name)


def cases_in(folders: Iterable[Path]) -> tuple[Case, ...]:
    """All cases in the folders, ordered by name. Raises ConfigError where a folder has none."""
    sources = [s for folder in folders for s in inside(folder).reports]
    return cases_of(sources)


def safe_id(name: str) -> str:
    """A name as a safe folder name: no path, not hidden, without control characters, not too long."""
    safe = re.sub(r'[\x00-\x1f\x7f/\\:*?"<>|]', "_", name.encode("utf-8", "replace").decode())
    safe = re.sub(r"^\.+", "_", safe).rstrip(" .") or "case"
    if len(safe.encode()) > MAX_NAME_BYTES:
        mark = hashlib.sha256(name.encode("utf-8", "replace")).hexdigest()[:8]
        safe = f"{safe.encode()[: MAX_NAME_BYTES - 9].decode('utf-8', 'ignore')}-{mark}"
    return safe


# ------------------------------------------------------------------ digest
def digest_of(case: Case, config: Config) -> str:
    """Fingerprint of everything a result depends on: report, config, prompts, plugin versions, code.

    The code's own text counts only where no model writes: there a new run costs seconds, and a stale result
    misleads; where one does it costs hours, and plugin versions tell when a result would change. A second opinion
    does not write: the rules' code still makes the result.
    """
    return job_digest(source_digest(case.source), config_digest(config))


def job_digest(source: str, config: str) -> str:
    """`digest_of` from its halves, each of which a batch needs once only."""
    return hashlib.sha256(f"{source}\n{config}".encode()).hexdigest()


def config_digest(config: Config) -> str:
    """Fingerprint of an experiment without its reports and its tracker. Raises ConfigError: an index is missing."""
    raw = {key: value for key, value in config.raw.items() if key != "tracker"}
    about = {
        "raw": raw,
        "name": config.name,
        "plugins": {qualified(p): identity(p) for p in _plugins(config)},
        "files": sorted({*named_digests(raw), *opinion_digests(config)}),
        "package": version("sg-cadvlm"),
        "code": code_digest(config.road_writer.asks_model or config.scenario_writer.asks_model),
    }
    return hashlib.sha256(json.dumps(about, sort_keys=True, default=str).encode()).hexdigest()


def opinion_digests(config: Config) -> list[str]:
    """Digest of the weights of the learned second reader that a config uses, if it uses one."""
    file = {LEARNED: WEIGHTS, WHOLE: NUMBERED_WEIGHTS}.get(config.second_opinion)
    return [_files_digest([file], file.parent)] if file else []


def _plugins(config: Config) -> Iterator[Plugin]:
    for value in (getattr(config, name) for name in type(config).model_fields if name != "tracker"):
        yield from (v for v in (value if isinstance(value, tuple) else (value,)) if isinstance(v, Plugin))


def code_digest(asks_model: bool) -> str:
    """Digest of the prompts and, where no model writes, of the code; `digest_of` gives the reason."""
    return _prompts_digest() if asks_model else _code_digest()


def named_digests(value: object) -> Iterator[str]:
    """Digests of files and folders that a configuration names, such as a script of answers or a model's weights."""
    if isinstance(value, dict | list):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from named_digests(inner)
    elif isinstance(value, str) and "\n" not in value and 0 < len(value) < 1000:
        for place in {Path(value), settings.ROOT / value}:
            if place.is_file():
                yield _files_digest([place], place)
            elif place.is_dir() and "/" in value:
                yield _folder_digest(place)


def _folder_digest(folder: Path) -> str:
    """Digest of a folder: by content up to 300 MB, larger ones by names and sizes of their files."""
    files = sorted(f for f in folder.rglob("*") if f.is_file())
    sizes = [(str(f.relative_to(folder)), f.stat().st_size) for f in files]
    small = sum(size for _, size in sizes) <= MAX_READ_BYTES
    return _files_digest(files, folder) if small else hashlib.sha256(repr(sizes).encode()).hexdigest()


def identity(plugin: Plugin) -> tuple[str, ...]:
    """Identity of a plugin's results beside its fields: version, stamp, and the code of a foreign plugin."""
    foreign_code = code_fingerprint(type(plugin))
    return (type(plugin).version, plugin.stamp, *([foreign_code] if foreign_code else []))


def qualified(plugin: Plugin) -> str:
    """A plugin's class as module:name."""
    return f"{type(plugin).__module__}:{type(plugin).__qualname__}"


def source_digest(source: Path) -> str:
    """Fingerprint of every file of a report, the facts that people gave among them."""
    try:
        files = files_below(source) if source.is_dir() else _file_and_facts(source)
    except (OSError, BadInput) as fault:  # the reader will say so, and it costs this case alone
        return hashlib.sha256(str(fault).encode("utf-8", "surrogateescape")).hexdigest()
    return _files_digest(files, source if source.is_dir() or len(files) == 1 else source.parent, MAX_FILE_BYTES)


def dataset_digest(cases: Iterable[Case]) -> str:
    """Fingerprint of a set of cases: names and every file's content, independent of their order."""
    lines = sorted(f"{case.id} {source_digest(case.source)}\n" for case in cases)
    return hashlib.sha256("".join(lines).encode("utf-8", "surrogateescape")).hexdigest()


def _file_and_facts(source: Path) -> list[Path]:
    """A report that is a file, and its facts.yaml."""
    facts = facts_file(source)
    return [source, facts] if facts.is_file() else [source]


@cache
def _prompts_digest() -> str:
    return _files_digest((f for f in sorted(settings.PROMPTS.rglob("*")) if f.is_file()), settings.PROMPTS)


@cache
def _code_digest() -> str:
    code = [f for part in ("sgcad_core", "plugins") for f in _sources(settings.ROOT / part)]
    return _files_digest(code, settings.ROOT) + _prompts_digest()


def _sources(package: Path) -> list[Path]:
    """Modules and the data that they read (rules, vocabulary): an edited wording changes results as code does."""
    return sorted(f for f in package.rglob("*") if f.suffix in CODE and f.is_file())


def _files_digest(files: Iterable[Path], root: Path, most: float = math.inf) -> str:
    """Digest of names and contents; of a file above `most` bytes by its size."""
    found = hashlib.sha256()
    for file in files:
        found.update(f"\n{file.relative_to(root)}\n".encode("utf-8", "surrogateescape"))
        try:
            if not is_regular(file):  # a pipe or a device never ends
                raise OSError("no regular file")
            if file.stat().st_size > most:  # no reader takes it
                raise OSError(f"{file.stat().st_size} bytes")
            found.update(bytes.fromhex(file_sha256(file)))
        except OSError as fault:  # the reader will say what is wrong with it
            found.update(str(fault).encode())
    return found.hexdigest()

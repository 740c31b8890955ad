"""Catalogs beside a scenario file: entries by catalog and entry name, read from the folders that the file names.

Reads regular .xosc and .xml files only, and of each folder no more than 200.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from itertools import islice
from pathlib import Path

from sgcad_core.errors import BadInput, InvalidOutput
from sgcad_core.formats.openscenario.reading.elements import XmlNode, read_root
from sgcad_core.formats.openscenario.reading.file_context import FileContext

MAX_FILES = 200
MAX_BYTES = 20_000_000
MAX_DEPTH = 10
_SUFFIXES = (".xosc", ".xml", ".xodr")


def read_text(file: Path) -> str:
    """A scenario's or map's text. Raises BadInput for what is no such file, or too large."""
    if file.suffix.lower() not in _SUFFIXES or not is_there(file):
        raise BadInput(f"{str(file)[-300:]}: no such file ({', '.join(_SUFFIXES)} are read)")
    if (size := file.stat().st_size) > MAX_BYTES:
        raise BadInput(f"{file}: {size} bytes, at most {MAX_BYTES} are read")
    data = file.read_bytes()
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def is_there(path: Path, *, folder: bool = False) -> bool:
    """Whether there is a regular file (or a folder) of that name; a name that no file can have is none."""
    try:
        return path.is_dir() if folder else path.is_file()
    except (OSError, ValueError):  # too long a name, or a null character in it
        return False


def located(folder: Path, path: str) -> Path:
    """A path in a file, relative to the folder that it lies in; Windows' separators are understood."""
    return folder / path.replace("\\", "/")


class CatalogFolders:
    """Implements `read.Catalogs` for the folders in a file's <CatalogLocations>."""

    def __init__(self, root: XmlNode, folder: Path) -> None:
        self._root, self._folder = root, folder
        self._sizes: dict[tuple[str, str], int] = {}

    def entry(self, reference: XmlNode) -> XmlNode:
        """The entry with its parameters assigned. Raises InvalidOutput naming what there is."""
        if reference.book.depth >= MAX_DEPTH:
            raise reference.fault(f"catalogs refer to each other more than {MAX_DEPTH} deep")
        catalog, name = reference.text("catalogName"), reference.text("entryName")
        if (catalog, name) not in self._entries:
            known = ", ".join(entry for of, entry in self._entries if of == catalog)
            names = ", ".join(sorted({of for of, _ in self._entries}))
            has = f"{catalog} has: {known[:500]}" if known else f"catalogs found: {names[:500] or 'none'}"
            raise reference.fault("no such catalog entry", f"{catalog}/{name}", has)
        file, found = self._entries[catalog, name]
        if (catalog, name) not in self._sizes:
            self._sizes[catalog, name] = sum(1 for _ in found.element.iter())
        reference.spend("elements of catalog entries", self._sizes[catalog, name])
        own = reference.book
        book = FileContext(file.name, self, own.notes, own.strict, own.depth + 1, own.budget)
        return XmlNode(found.element, reference.scope, book).scoped(_assigned(reference))

    @cached_property
    def _entries(self) -> dict[tuple[str, str], tuple[Path, XmlNode]]:
        found: dict[tuple[str, str], tuple[Path, XmlNode]] = {}
        for file in dict.fromkeys(self._files()):
            book = FileContext(file.name, notes=self._root.book.notes, strict=False, budget=self._root.book.budget)
            root = read_root(read_text(file), book=book)
            if (catalog := root.find("Catalog")) is None:
                continue
            for entry in catalog.children():
                found.setdefault((catalog.text("name"), entry.name), (file, entry))
        for (_, name), place in list(found.items()):  # some call a catalog by its file
            found.setdefault((place[0].stem, name), place)
        return found

    def _files(self) -> Iterator[Path]:
        locations, listed = self._root.find("CatalogLocations"), set[Path]()
        for kind in locations.children() if locations else ():
            path = located(self._folder, kind.need("Directory").text("path"))
            if path in listed:
                continue
            listed.add(path)
            kind.spend("catalog folders")
            if not is_there(path, folder=True):
                yield from [path] if is_there(path) else []
                continue
            files = list(islice(path.glob("*.xosc"), MAX_FILES + 1))
            if len(files) > MAX_FILES:
                raise kind.fault(f"more than {MAX_FILES} catalog files in one folder", str(path))
            yield from sorted(files)


def _assigned(reference: XmlNode) -> dict[str, str]:
    """Values that a reference gives to the entry's parameters."""
    holder, given = reference.find("ParameterAssignments"), dict[str, str]()
    for entry in holder.children("ParameterAssignment") if holder else ():
        try:
            given[str(entry.element.get("parameterRef", "")).lstrip("$")] = entry.text("value")
        except InvalidOutput as fault:
            entry.doubt(fault.findings[0].what, fault.findings[0].value, "the parameter's default is taken")
    return given

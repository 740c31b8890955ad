"""Prefect's result storage at an address that every machine reaches: s3://bucket/alpha, gs://..., file:///mnt/x.

The starter saves a Prefect block of the address (`save`), workers load it by name (`storage`). Keys and endpoints come
from the environment of each machine. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import hashlib
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, cast
from urllib.parse import urlsplit
from urllib.request import url2pathname

import fsspec
from prefect.filesystems import RemoteFileSystem

from sgcad_core.errors import MissingTool

PROBE = ".sgcad"

Storage = Path | RemoteFileSystem


def save(address: str) -> Storage:
    """The storage of an address, known to Prefect's server. Raises MissingTool if nothing can be written there."""
    if folder := _folder(address):
        _probe(fsspec.filesystem("file", auto_mkdir=True), f"{folder}/{PROBE}", address)
        return folder
    block = RemoteFileSystem(basepath=address, settings={"use_listings_cache": False})
    _probe(block, f"{address.rstrip('/')}/{PROBE}", address)
    block.save(_name(address), overwrite=True)
    return storage(address)


@cache
def storage(address: str) -> Storage:
    """The storage of an address that was saved; a folder for a file's address or a plain path."""
    return _folder(address) or cast("RemoteFileSystem", RemoteFileSystem.load(_name(address)))


def _folder(address: str) -> Path | None:
    if address.startswith(("file:", "local:")):
        return Path(url2pathname(urlsplit(address).path))
    return None if "://" in address else Path(address)


def _name(address: str) -> str:
    return f"sgcad-{hashlib.sha256(address.encode()).hexdigest()[:12]}"


def _probe(place: Any, name: str, address: str) -> None:
    """Write a byte, so that a wrong address is told before the first case."""
    try:
        (place.filesystem if isinstance(place, RemoteFileSystem) else place).pipe_file(name, b"1")
    except Exception as fault:
        raise MissingTool(
            f"--store {address}: cannot be written ({type(fault).__name__}: {fault}); is the address right, its "
            "library installed (s3: pip install s3fs), the network up?"
        ) from fault


# ------------------------------------------------------------------ kept results, as Prefect's block sees them
def read(block: Any, key: str) -> bytes | None:
    """A kept result's bytes; None where there is none."""
    place, name = _place(block, key)
    try:
        return bytes(place.cat_file(name))
    except FileNotFoundError:
        return None


def remove(block: Any, key: str) -> None:
    """Remove a kept result."""
    place, name = _place(block, key)
    with suppress(FileNotFoundError):
        place.rm_file(name)


def _place(block: Any, key: str) -> tuple[Any, str]:
    """File system and name of a key in a LocalFileSystem or RemoteFileSystem."""
    place = block.filesystem if isinstance(block, RemoteFileSystem) else fsspec.filesystem("file")
    return place, f"{str(block.basepath).rstrip('/')}/{key}"

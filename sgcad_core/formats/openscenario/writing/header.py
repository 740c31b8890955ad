"""Where a scenario file comes from: its header and the comments before it. Knows no scenario.

The text of a scenario that is planned has no date, so that equal scenarios are equal; the date is put in where a file
is written. SOURCE_DATE_EPOCH (seconds since 1970) sets another one, for files that are to be reproduced.
"""

from __future__ import annotations

import datetime
import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

from sgcad_core import settings

AUTHOR = "SG-CADVLM"
UNDATED = "2000-01-01T00:00:00"
_LONGEST = 200
_NOT_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_HEADER = re.compile(r'<FileHeader description="[^"]*"')
_DATE = re.compile(r'(<FileHeader\b[^>]*?) date="[^"]*"')


@dataclass(frozen=True)
class Source:
    """What a file is made of."""

    case: str
    about: str = ""
    """The crash in a few words."""
    assumed: tuple[str, ...] = ()
    """What no report told and the scenario has nevertheless."""
    date: str = UNDATED

    @property
    def description(self) -> str:
        """For the header; one line."""
        told = f"{self.case}: {self.about}" if self.about else self.case
        return _NOT_XML.sub("?", " ".join(told.split()))[:_LONGEST]


def today() -> str:
    """Today, or what SOURCE_DATE_EPOCH says, as the header wants it: UTC. The day alone, so that what is undone or run
    again on one day gives the same file."""
    given = settings.environment("SOURCE_DATE_EPOCH")
    fixed = datetime.datetime.fromtimestamp(int(given), datetime.UTC) if given.isdecimal() else None
    return (fixed or datetime.datetime.now(datetime.UTC)).strftime("%Y-%m-%dT00:00:00")


def file_header(source: Source, minor: int) -> ET.Element:
    """The element of the header in version 1.`minor`."""
    told = {"description": source.description, "author": AUTHOR, "revMajor": "1", "revMinor": str(minor)}
    return ET.Element("FileHeader", told | {"date": source.date})


def comments(source: Source, said: Sequence[str] = ()) -> str:
    """Comments that stand before the root: the crash, what is said, what is assumed."""
    lines = [f"Source: crash report {source.description}", *said, *(f"Assumed: {line}" for line in source.assumed)]
    return "".join(f"<!-- {_harmless(line)} -->\n" for line in lines)


def stamped(xosc: str, source: Source) -> str:
    """A scenario that was planned, with its source, date and assumptions; else unchanged."""
    text = _HEADER.sub(lambda _: f"<FileHeader description={quoteattr(source.description)}", xosc, count=1)
    text = _DATE.sub(lambda found: f'{found[1]} date="{source.date}"', text, count=1)
    head, end, rest = text.partition("?>\n")
    return f"{head}{end}{comments(source)}{rest}" if end else text


def _harmless(text: str) -> str:
    """Text that may stand in a comment: no double hyphen, one line."""
    return re.sub(r"-+", "-", _NOT_XML.sub("?", " ".join(text.split()))).strip("-")[:_LONGEST]

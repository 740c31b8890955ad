"""A tracker's record of a config before its first case: one arm of a comparison. Knows no plugin and no flow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import Field

from sgcad_core.case.records import Record


class Dataset(Record):
    """The reports that an arm runs over."""

    name: str
    digest: str
    """SHA-256 over the cases' names and files."""
    source: str
    """The folder that all of them lie in."""
    cases: int


class Arm(Record):
    """One config over one set of reports."""

    config: str
    params: dict[str, Any] = Field(repr=False)
    """The effective configuration: every plugin with all its fields, defaults too; the same in every `log_case`."""
    out: str
    """The folder that holds <config>/<case>/."""
    dataset: Dataset
    plugins: Mapping[str, str]
    """By kind (validators by name): class, version and, where the plugin has one, stamp."""
    prompts: Mapping[str, str] = Field(default_factory=dict, repr=False)
    """Texts of the files in configs/prompts/ that a model is asked with, by name; empty without a model."""
    live: bool = True
    """Whether the cases run while they are logged; false where they are logged later, from their folders."""
    git_commit: str = ""
    hardware: Mapping[str, Any] = Field(default_factory=dict)
    fault: str = ""
    """At the end: what ended the batch before its last case; empty where it finished or a person interrupted it."""

"""`sgcad export` and `sgcad video`: finished cases for other tools, and as films."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from sgcad_core.case.density import DENSITIES, NO_TRAFFIC, Density
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.formats.openscenario.writing.versions import VERSIONS, Version

Cases = Annotated[list[Path], typer.Argument(help="Folders of finished cases, or a folder of runs.")]
Ego = Annotated[
    str, typer.Option("--ego", help="The vehicle that your stack drives: an actor such as V1, or responder, initiator.")
]


def export(
    cases: Cases,
    formats: Annotated[
        str,
        typer.Option("--format", "-f", help="ego (default), commonroad, dsl, scenarionet; several with commas."),
    ] = "",
    ego: Ego = "responder",
    version: Annotated[str, typer.Option("--openscenario", help="Version of ego.xosc: 1.0, 1.1, 1.2, 1.3.")] = "1.2",
    traffic: Annotated[
        str, typer.Option("--traffic", help="Traffic around the crash: light or dense; files in export/traffic/.")
    ] = NO_TRAFFIC,
    seed: Annotated[int, typer.Option("--seed", help="Of the traffic: equal seeds give equal traffic.", min=0)] = 42,
) -> None:
    """Write finished cases for other tools: a scenario that your stack drives, other formats, traffic around it.

    Files are written to export/<format>/ in each case's folder; docs/export.md says what they hold.
    """
    from flows.drive.script_of_case import case_folders
    from flows.export.export_traffic import export_traffic
    from flows.export.finished_case import FinishedCase
    from flows.export.formats import FORMATS, Wish

    density = _density(traffic)
    named = [name.strip() for name in formats.split(",") if name.strip()] if formats else []
    if not formats and density is None:
        named = ["ego"]
    if (formats and not named) or (wrong := [name for name in named if name not in FORMATS]):
        raise ConfigError(f"--format {wrong[0] if named else formats!r}: no such format; formats: {', '.join(FORMATS)}")
    wish = Wish(ego, _version(version))
    for folder in case_folders(cases):
        case = FinishedCase(folder)
        for name in named:
            _tell(FORMATS[name](case, folder / "export" / name, wish))
        if density:
            _tell(export_traffic(case, folder / "export" / "traffic", wish, density, seed))


def _tell(files: Iterable[Path]) -> None:
    for file in files:
        typer.echo(str(file))


def _density(text: str) -> Density | None:
    found = next((density for density in DENSITIES if density == text), None)
    if found is None and text != NO_TRAFFIC:
        raise ConfigError(f"--traffic {text}: no such density; densities: {', '.join(DENSITIES)}, {NO_TRAFFIC}")
    return found


def _version(text: str) -> Version:
    found = next((version for version in VERSIONS if version == text), None)
    if found is None:
        raise ConfigError(f"--openscenario {text}: no such version; versions: {', '.join(VERSIONS)}")
    return found


def video(
    cases: Cases,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Folder for the films; default: the case's.")] = None,
    kinds: Annotated[
        str, typer.Option("--format", "-f", help="mp4, gif, or both with a comma; default: both, a gif without ffmpeg.")
    ] = "",
    fps: Annotated[int, typer.Option(help="Frames a second of the mp4; a gif has 10 at most.", min=5, max=60)] = 20,
) -> None:
    """Film finished cases: plan view, report, speeds and the verdict; crash.mp4 and crash.gif in each case's folder."""
    from flows.drive.script_of_case import case_folders
    from flows.export.film import KINDS, check_ffmpeg, film

    named = [kind.strip() for kind in kinds.split(",") if kind.strip()] if kinds else list(KINDS)
    if not kinds:
        try:
            check_ffmpeg()
        except MissingTool as fault:
            typer.echo(f"no {fault}", err=True)
            named.remove("mp4")
    if not named or (wrong := [kind for kind in named if kind not in KINDS]):
        raise ConfigError(f"--format {wrong[0] if named else kinds!r}: no such film; films: {', '.join(KINDS)}")
    for folder in case_folders(cases):
        for file in film(folder, out or folder, named, fps):
            typer.echo(str(file))

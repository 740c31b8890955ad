"""`sgcad drive` and `sgcad vary`: finished cases driven by drivers, or varied into families."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from functools import partial
from pathlib import Path
from typing import Annotated, Any, TextIO

import typer

from sgcad_core.errors import ConfigError

Cases = Annotated[list[Path], typer.Argument(help="Folders of finished cases, or a folder of runs.")]
Drivers = Annotated[
    list[str] | None,
    typer.Option("--driver", "-d", help="A name, YAML such as '{name: reference, model: fuzzy}', or @FILE: a list."),
]
RoleOf = Annotated[
    list[str] | None,
    typer.Option("--role-of", help="ACTOR=ROLE, such as V1=responder; overrides the role read from the report."),
]
Release = Annotated[
    float,
    typer.Option(
        "--release", min=0.0, max=30.0, help="Time before the contact, s, from which other actors ignore the ego."
    ),
]
Factor = Annotated[
    float,
    typer.Option("--factor", min=0.2, max=3.0, help="Ratio of the ego's speed at the hand-over to the scripted speed."),
]


def drive(
    cases: Cases,
    driver: Drivers = None,
    ego: Annotated[str, typer.Option("--ego", help="The actor to be driven, such as V1.")] = "",
    role: Annotated[str, typer.Option("--role", help="initiator, responder, bystander; both: the first two.")] = "both",
    role_of: RoleOf = None,
    release: Release = 4.0,
    factor: Factor = 1.0,
    jobs: Annotated[int, typer.Option("--jobs", "-j", min=1, help="Cases at a time.")] = 1,
    fresh: Annotated[bool, typer.Option("--fresh", help="Repeat finished drives.")] = False,
    csv: Annotated[Path | None, typer.Option("--csv", help="Write one line per drive to this file.")] = None,
    pages: Annotated[bool, typer.Option("--pages/--no-pages", help="Write drive.html beside drive.json.")] = True,
) -> None:
    """Let drivers drive one actor of finished crashes: avoided, mitigated, unchanged, worse or lost.

    Files are written to drive/ in each case's folder.
    """
    from rich.console import Console

    from flows.drive import table
    from flows.drive.run_drive import Order, drive_folders, first_page
    from flows.drive.script_of_case import case_folders
    from flows.terminal import escape_plain
    from sgcad_core.config import driver_entry

    order = Order(
        drivers=tuple(driver_entry(entry) for text in driver or ["reference"] for entry in _entries(text)),
        ego=ego, roles=_roles(role), release_s=release, factor=factor, role_of=_given(role_of or []),
        fresh=fresh, pages=pages,
    )  # fmt: skip
    folders = case_folders(cases)
    told, tally = drive_folders(folders, order, jobs), table.Tally()
    with _opened(csv) as out:
        for one in table.as_csv(out, told) if out else told:
            tally.add(one)
    table.show(Console(emoji=False, highlight=False), tally)
    if csv:
        typer.echo(f"written: {csv}")
    if page := first_page(folders, order):
        typer.echo(escape_plain(f"look at: {page}"))
    raise typer.Exit(int(tally.failed > 0))


def _opened(file: Path | None) -> AbstractContextManager[TextIO | None]:
    return nullcontext() if file is None else file.open("w", encoding="utf-8", newline="")


def _entries(text: str) -> list[Any]:
    """Drivers of one --driver option: one, or with @FILE those of a YAML list."""
    if not text.startswith("@"):
        return [_yaml(text)]
    try:
        listed = _yaml(Path(text[1:]).read_text(encoding="utf-8"))
    except OSError as fault:
        raise ConfigError(f"--driver {text}: cannot be read ({fault.strerror}); give a YAML file") from fault
    if not isinstance(listed, list) or not listed:
        raise ConfigError(f"--driver {text}: no list of drivers; write one driver per line, each after a dash")
    return listed


def _yaml(text: str) -> Any:
    import yaml

    from sgcad_core.system.yaml_faults import YAML_FAULTS

    try:
        return yaml.safe_load(text)
    except YAML_FAULTS as fault:
        raise ConfigError(f"--driver {text!r}: no YAML ({fault}); give a name or {{name: ..., field: ...}}") from fault


def _roles(role: str) -> tuple[str, ...]:
    from sgcad_core.kinds import CRASH_ROLES

    if role == "both":
        return ("initiator", "responder")
    if role not in CRASH_ROLES:
        raise ConfigError(f"--role {role}: no such role; roles: {', '.join(CRASH_ROLES)}, both")
    return (role,)


def _given(entries: list[str]) -> dict[str, str]:
    if wrong := next((e for e in entries if "=" not in e), None):
        raise ConfigError(f"--role-of {wrong}: write ACTOR=ROLE, such as V1=responder")
    return dict(e.split("=", 1) for e in entries)


def vary(
    cases: Cases,
    count: Annotated[int, typer.Option("-n", "--count", min=1, max=10_000, help="Members of each family.")] = 200,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Equal seeds give equal families.")] = 1,
    driver: Annotated[str, typer.Option("--driver", "-d", help="Search the hardest members for this driver.")] = "",
    role: Annotated[str, typer.Option("--role", help="Role of the actor that it drives.")] = "responder",
    search: Annotated[
        str,
        typer.Option(
            "--search", help="cross-entropy: one hardest region; map-elites: the hardest member of each kind."
        ),
    ] = "cross-entropy",
    role_of: RoleOf = None,
) -> None:
    """Vary what a report leaves open: a family of the same crash as scenario files, in vary/ of each case's folder."""
    from flows.drive.families import family_of, write_family
    from flows.drive.family_words import family_lines
    from flows.drive.hardest_search import METHODS, Search, hardest
    from flows.drive.script_of_case import case_folders
    from flows.terminal import escape_plain
    from sgcad_core.config import driver_entry

    entry = driver_entry(_yaml(driver)) if driver else None
    roles = _roles(role)
    if len(roles) != 1:
        raise ConfigError(f"--role {role}: a family is driven in one role; give initiator or responder")
    method = next((m for m in METHODS if m == search), None)
    if method is None:
        raise ConfigError(f"--search {search}: no such search; there are {', '.join(METHODS)}")
    look = Search(entry, roles[0], method) if entry else None
    for folder in case_folders(cases):
        family = family_of(folder, _given(role_of or []))
        place = write_family(family, count, seed, partial(hardest, family, count, seed, look) if look else None)
        typer.echo("\n".join(map(escape_plain, family_lines(place))))
        if count_left := len(family.basis.script.background):
            typer.echo(f"the {count_left} vehicles of its traffic are left out: a family varies the crash alone")

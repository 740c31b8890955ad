"""The command line: `sgcad run | evaluate | revise | desk | play | study | table | report | plugins | check ...`.

Exit codes: 0 done (a refusal included); 1 a case failed or was exhausted; 2 wrong input or configuration, nothing was
started; 130 interrupted. Heavy libraries are imported inside the commands, so that --help is quick.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from flows.case.revise_command import revise
from flows.command_end import at_end, guarded, heed_interrupts, interrupted, leave
from flows.desk.command import desk_app
from flows.drive.commands import drive, vary
from flows.export.command import export, video
from flows.index_commands import index_app
from flows.plugin_commands import check, plugins_app
from flows.results.report.commands import report, score, table
from flows.terminal import escape_plain
from sgcad_core import settings

if TYPE_CHECKING:
    from flows.batch.plan_batch import Batch
    from flows.batch.progress_bar import BatchProgress
    from flows.case_files.find_cases import Case

Result = TypeVar("Result")

DEFAULT_OUT = Path("runs")

app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False)
app.add_typer(plugins_app, name="plugins")
app.add_typer(index_app, name="index")
app.add_typer(desk_app, name="desk")

Configs = Annotated[
    list[Path] | None, typer.Option("--config", "-c", help="A config (YAML file or name); may be given several times.")
]
Overrides = Annotated[list[str] | None, typer.Option("--set", help="Override KEY=VALUE, such as decoder.alpha=0.3.")]
Out = Annotated[Path, typer.Option("--out", "-o", help="Folder for the results.")]
Jobs = Annotated[
    int | None, typer.Option("--jobs", "-j", help="Cases at a time; default: the number of cores, 8 with a model.")
]
Encoding = Annotated[str, typer.Option("--encoding", help="Encoding of the plan in the .xosc: timed or events.")]
Traffic = Annotated[str, typer.Option("--traffic", help="Traffic around the crash: light, dense or none.")]
Places = Annotated[
    str,
    typer.Option("--places", help="An OpenStreetMap extract or a folder of them, for the streets that reports name."),
]
Judge = Annotated[str, typer.Option("--judge", help="A second simulator, such as esmini, whose motion is compared.")]
Fresh = Annotated[bool, typer.Option("--fresh", help="Run finished cases again.")]
Detail = Annotated[
    str, typer.Option("--detail", help="What Prefect is shown: every step of a case (stage), or cases only (case).")
]
Workers = Annotated[
    str,
    typer.Option(
        "--workers",
        help="Where cases run: threads, processes, dask, or a Dask scheduler (tcp://host:8786); auto: processes, "
        "threads with a model.",
    ),
]

Store = Annotated[
    str, typer.Option("--store", help="Where a Dask cluster keeps results: s3://..., gs://... (docs/scale.md).")
]


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"sgcad {version('sg-cadvlm')}")
        raise typer.Exit


@app.callback()
def whole(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Turn crash reports into road networks and scenarios that a simulator runs."""


@app.command()
def run(
    reports: Annotated[list[Path], typer.Argument(help="Case folders, or .txt, .xml, .pdf files.")],
    config: Configs = None,
    overrides: Overrides = None,
    out: Out = DEFAULT_OUT,
    jobs: Jobs = None,
    fresh: Fresh = False,
    encoding: Encoding = "",
    traffic: Traffic = "",
    places: Places = "",
    server: Annotated[
        bool, typer.Option("--server", help="Show the run in Prefect; so it is where PREFECT_API_URL names a server.")
    ] = False,
) -> None:
    """Turn reports into scenarios."""
    from flows.batch import run_batch
    from flows.batch.tracking import track_rest
    from flows.case_files.find_cases import cases_of

    made = _batch(
        cases_of(reports), config, [*(overrides or ()), *_options(encoding, traffic, places)], out, jobs, fresh
    )
    shown = server or bool(settings.prefect_url())
    run_them = run_batch.evaluate if shown else run_batch.evaluate_alone
    code, _ = _carry_out(made, lambda watch: run_them(made, watch.ended, on_step=watch.step))
    if shown:
        leave(code)
    track_rest.start(made.out, made.configs)
    raise typer.Exit(code)


@app.command()
def evaluate(
    cases: Annotated[list[Path], typer.Argument(help="A folder of case folders.")],
    config: Configs = None,
    overrides: Overrides = None,
    out: Out = DEFAULT_OUT,
    jobs: Jobs = None,
    fresh: Fresh = False,
    judge: Judge = "",
    encoding: Encoding = "",
    traffic: Traffic = "",
    places: Places = "",
    detail: Detail = "stage",
    workers: Workers = "auto",
    store: Store = "",
) -> None:
    """Run every case of a folder under one or several configs; the same command again resumes it."""
    from flows.batch import run_batch
    from flows.case_files.find_cases import cases_in
    from flows.case_files.folder_cases import left_out

    judged = [f"judge.name={judge}"] if judge else []
    named = [*(overrides or ()), *judged, *_options(encoding, traffic, places)]
    made = _batch(cases_in(cases), config, named, out, jobs, fresh).shown(detail, workers, store)
    made = dataclasses.replace(made, left=left_out(cases))
    leave(_carry_out(made, lambda watch: run_batch.evaluate(made, watch.ended, on_step=watch.step))[0])


def _options(encoding: str, traffic: str, places: str) -> list[str]:
    """Options as overrides; loading the config reports a wrong value or a plugin without this choice."""
    told = {"scenario_writer.encoding": encoding, "traffic": traffic, "road_writer.places": places}
    return [f"{key}={value}" for key, value in told.items() if value]


def _batch(
    found: Sequence[Case], config: list[Path] | None, overrides: list[str], out: Path, jobs: int | None, fresh: bool
) -> Batch:
    """The whole batch, checked."""
    from flows.batch import plan_batch

    return plan_batch.batch_of(found, settings.configs_or_default(config), out, overrides, jobs, fresh)


def _carry_out(made: Batch, work: Callable[[BatchProgress], Result]) -> tuple[int, Result]:
    """Work under a progress bar, then print the summary; the exit code and the result of the work."""
    from flows.batch import config_folder, progress_bar, summary
    from flows.case_files import case_folder
    from sgcad_core.system.private_folders import deny_others

    deny_others()
    for config in made.configs:
        if line := config_folder.replaced(made.out / config.name, config):
            sys.stderr.write(f"sgcad: note: {line}\n")
        at_end.append(partial(case_folder.clear_partial, made.out / config.name, own=True))
    tally = summary.Tally(made)
    stopped = heed_interrupts()
    try:
        with progress_bar.batch_progress(tally) as watch:
            result = work(watch)
    except BaseException as fault:
        # A library may answer the interrupt with an error of its own (pydantic does, in the midst of serializing).
        if not (stopped.is_set() or isinstance(fault, KeyboardInterrupt)):
            raise
        interrupted()
    summary.show(tally)
    return tally.exit_code(), result


@app.command()
def study(
    file: Annotated[Path, typer.Argument(help="A study's YAML, or its name in configs/studies/.")],
    cases: Annotated[list[Path] | None, typer.Option("--cases", help="A folder of case folders.")] = None,
    truth: Annotated[Path | None, typer.Option("--truth", help="A folder of truth files, <case>.json.")] = None,
    overrides: Overrides = None,
    out: Out = DEFAULT_OUT,
    jobs: Jobs = None,
    fresh: Fresh = False,
    detail: Detail = "stage",
    workers: Workers = "auto",
    store: Store = "",
) -> None:
    """Compare arms over the same cases; stages that arms share are computed once.

    An interrupted study resumes by its name alone, with the cases and overrides that it was started with.
    """
    from flows.study import plan, resume, run_study
    from flows.study_file import spec

    known = resume.former_arguments(file, out)
    given = resume.cases_of(known, tuple(cases or ())), truth or known.truth, overrides or known.overrides
    study = spec.load_study(known.file)
    made = plan.plan(study, out, cases=given[0], truth=given[1], overrides=given[2], jobs=jobs, fresh=fresh)
    made = dataclasses.replace(made, batch=made.batch.shown(detail, workers, store))
    code, cost = _carry_out(made.batch, lambda watch: run_study.run(made, watch.ended, watch.step))
    typer.echo(run_study.cost_line(made, cost))
    leave(code)


@app.command()
def play(
    file: Annotated[Path, typer.Argument(help="An OpenSCENARIO file (.xosc), or one with a parameter distribution.")],
    out: Out = Path("played"),
    given: Annotated[list[str] | None, typer.Option("--set", help="NAME=VALUE for a parameter of the file.")] = None,
    maps: Annotated[
        list[Path] | None, typer.Option("--maps", help="A folder with the maps that the file names.")
    ] = None,
    sets: Annotated[int, typer.Option(help="Maximum number of parameter sets to play.", min=1)] = 20,
    until: Annotated[float, typer.Option(help="Maximum simulated time, s.", min=0.1, max=300)] = 300.0,
) -> None:
    """Play any scenario file; writes trajectories.csv, player.html, contacts.json, metrics.json, played.json."""
    from flows.player import play_any_xosc

    for folder in play_any_xosc.play(file, out, given or (), maps or (), sets, until):
        typer.echo(str(folder / "player.html"))


@app.command()
def explain(
    case: Annotated[Path, typer.Argument(help="A finished case's folder, or a report to read now.")],
) -> None:
    """Show how a report was read: each sentence with its facts, the inferred facts, the assumed ones."""
    from flows.case.explain import explain as account

    typer.echo(escape_plain(account(case)))


@app.command()
def doctor(
    out: Out = DEFAULT_OUT,
    services: Annotated[
        bool, typer.Option("--services", help="Also run a Prefect flow on a server, and log a run to MLflow (20 s).")
    ] = False,
) -> None:
    """Check that every needed program and service is installed and works."""
    from flows.doctor import examine

    raise typer.Exit(0 if examine(out, services) else 1)


for command in (check, drive, vary, export, video, table, report, score, revise):
    app.command()(command)


def main() -> None:
    """Run the command line."""
    guarded(app)


if __name__ == "__main__":
    main()

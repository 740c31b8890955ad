"""The command line: `sgcad run | evaluate | revise | desk | play | study | table | report | plugins | check ...`.

Exit codes: 0 done (a refusal included); 1 a case failed or was exhausted; 2 wrong input or configuration, nothing was
started; 130 interrupted. Heavy libraries are imported inside the commands, so that --help is quick.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from flows.case.revise_command import revise
from flows.desk.command import desk_app
from flows.drive.commands import drive, vary
from flows.index_commands import index_app
from flows.plugin_commands import plugins_app
from flows.results.report.commands import report, score, table
from flows.terminal import escape_plain
from sgcad_core import settings
from sgcad_core.errors import SgcadError

if TYPE_CHECKING:
    from flows.batch.plan_batch import Batch
    from flows.batch.progress_bar import BatchProgress
    from flows.case_files.find_cases import Case

Result = TypeVar("Result")

DEFAULT_OUT = Path("runs")
PATIENCE_S = 5.0

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
Judge = Annotated[str, typer.Option("--judge", help="A second simulator, such as esmini, whose motion is compared.")]
Fresh = Annotated[bool, typer.Option("--fresh", help="Run finished cases again.")]


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
) -> None:
    """Turn reports into scenarios."""
    from flows.case_files.find_cases import cases_of

    _batch(cases_of(reports), config, [*(overrides or ()), *_encoded(encoding)], out, jobs, fresh)


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
) -> None:
    """Run every case of a folder under one or several configs; the same command again resumes it."""
    from flows.case_files.find_cases import cases_in

    judged = [f"judge.name={judge}"] if judge else []
    _batch(cases_in(cases), config, [*(overrides or ()), *judged, *_encoded(encoding)], out, jobs, fresh)


def _encoded(encoding: str) -> list[str]:
    """The option as an override; loading the config reports a wrong value or a writer without this choice."""
    return [f"scenario_writer.encoding={encoding}"] if encoding else []


def _batch(
    found: Sequence[Case], config: list[Path] | None, overrides: list[str], out: Path, jobs: int | None, fresh: bool
) -> None:
    """Check the whole batch, then run it and exit."""
    from flows.batch import plan_batch, run_batch

    made = plan_batch.batch_of(found, settings.configs_or_default(config), out, overrides, jobs, fresh)
    raise typer.Exit(_carry_out(made, lambda watch: run_batch.evaluate(made, watch.ended, on_turn=watch.turn))[0])


def _carry_out(made: Batch, work: Callable[[BatchProgress], Result]) -> tuple[int, Result]:
    """Work under a progress bar, then print the summary; the exit code and the result of the work."""
    from flows.batch import config_folder, progress_bar, summary

    for config in made.configs:
        if line := config_folder.replaced(made.out / config.name, config):
            sys.stderr.write(f"sgcad: note: {line}\n")
    tally = summary.Tally(made)
    stopped = _heed_interrupts()
    try:
        with progress_bar.batch_progress(tally) as watch:
            result = work(watch)
    except BaseException as fault:
        # A library may answer the interrupt with an error of its own (pydantic does, in the midst of serializing).
        if not (stopped.is_set() or isinstance(fault, KeyboardInterrupt)):
            raise
        _interrupted()
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
    hosts: Annotated[
        str, typer.Option("--hosts", help="Shared storage of several hosts, an fsspec address (docs/scale.md).")
    ] = "",
    deployment: Annotated[str, typer.Option(help="Deployment that the hosts' workers serve.")] = "shard/shard",
) -> None:
    """Compare arms over the same cases; stages that arms share are computed once.

    An interrupted study resumes by its name alone, with the cases and overrides that it was started with.
    """
    from flows.deploy import hosts_preflight
    from flows.study import plan, resume, run_study
    from flows.study.watch_shards import Hosts
    from flows.study_file import spec

    known = resume.former_arguments(file, out)
    given = resume.cases_of(known, tuple(cases or ())), truth or known.truth, overrides or known.overrides
    study = spec.load_study(known.file)
    made = plan.plan(study, out, cases=given[0], truth=given[1], overrides=given[2], jobs=jobs, fresh=fresh)
    if hosts:
        meeting = Hosts(hosts, deployment)
        code, submitted = _carry_out(made.batch, lambda watch: hosts_preflight.run(made, meeting, watch.ended))
        typer.echo(hosts_preflight.resubmitted_lines(submitted))
        raise typer.Exit(code)
    code, cost = _carry_out(made.batch, lambda watch: run_study.run(made, watch.ended, watch.turn))
    typer.echo(run_study.cost_line(made, cost))
    raise typer.Exit(code)


@app.command()
def check(
    config: Annotated[Path, typer.Argument(help="The YAML of a config or of a study.")],
    overrides: Overrides = None,
) -> None:
    """Check a config, or all arms of a study, without starting anything."""
    from flows.catalogue import describe_config
    from flows.study import plan
    from flows.study_file import spec
    from flows.study_file.arm_config import load_config

    if study_file := spec.study_in(config):
        typer.echo(plan.described(spec.load_study(study_file), tuple(overrides or ())))
        return
    describe_config(load_config(config, tuple(overrides or ())))


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
def doctor(out: Out = DEFAULT_OUT) -> None:
    """Check that every needed program and service is installed and works."""
    from flows.doctor import examine

    raise typer.Exit(0 if examine(out) else 1)


for command in (drive, vary, table, report, score, revise):
    app.command()(command)


def main() -> None:
    """Run the command line."""
    guarded(app)


def guarded(command: Callable[[], object]) -> None:
    """Run a command; every error becomes one message on stderr and an exit code."""
    try:
        command()
    except SgcadError as fault:
        _end(str(fault), 2)
    except KeyboardInterrupt:
        _interrupted()
    except Exception as fault:  # noqa: BLE001 - the command line's edge
        traceback.print_exception(fault)
        _end(f"unexpected {type(fault).__name__}: {fault}; `sgcad doctor` checks the installation", 1)


def _end(message: str, code: int) -> None:
    sys.stderr.write(f"sgcad: error: {escape_plain(message)}\n")
    _leave(code)


def _heed_interrupts() -> threading.Event:
    """Let the first Ctrl-C stop the batch in order, within 5 s; the second at once. The event is set by the first."""
    stopped = threading.Event()
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return stopped  # the parent process ignores Ctrl-C

    def first(number: int, frame: object) -> None:
        stopped.set()
        signal.signal(signal.SIGINT, lambda *_: _interrupted())
        patience = threading.Timer(PATIENCE_S, _interrupted)
        patience.daemon = True
        patience.start()
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, first)
    return stopped


def _interrupted() -> None:
    sys.stderr.write("sgcad: interrupted; finished cases are kept, run the same command again to go on\n")
    _leave(130)


def _leave(code: int) -> None:
    """Exit at once: threads may wait for a model or a simulator, and their processes must end too."""
    import psutil

    sys.stdout.flush()
    sys.stderr.flush()
    for child in psutil.Process().children(recursive=True):
        try:
            child.kill()
        except psutil.NoSuchProcess:
            continue
    os._exit(code)


if __name__ == "__main__":
    main()

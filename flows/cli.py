"""The command line: `sgcad run | evaluate | revise | desk | play | study | table | report | plugins | check ...`.

Exit codes: 0 done (a refusal included), 1 a case failed or was exhausted, 2 bad input or configuration and
nothing was started, 130 interrupted. Heavy libraries are imported inside the commands, so that --help is
quick; `except Exception` stands here once, at the edge.
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
    from flows.batch.progress_bar import Watch

Result = TypeVar("Result")

DEFAULT_OUT = Path("runs")
PATIENCE_S = 5.0

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.add_typer(plugins_app, name="plugins")
app.add_typer(index_app, name="index")
app.add_typer(desk_app, name="desk")

Configs = Annotated[list[Path] | None, typer.Option("--config", "-c", help="A YAML; may be given several times.")]
Overrides = Annotated[list[str] | None, typer.Option("--set", help="key=value, such as decoder.alpha=0.3.")]
Out = Annotated[Path, typer.Option("--out", "-o", help="Folder for the results.")]
Jobs = Annotated[int | None, typer.Option("--jobs", "-j", help="Cases at a time; default: the cores, with a model 8.")]
Encoding = Annotated[str, typer.Option("--encoding", help="How the .xosc tells the plan: timed or events.")]
Judge = Annotated[str, typer.Option("--judge", help="A second simulator, such as esmini: does it play the same?")]
Fresh = Annotated[bool, typer.Option("--fresh", help="Do finished cases again.")]


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"sgcad {version('sg-cadvlm')}")
        raise typer.Exit


@app.callback()
def whole(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Which one.")] = False,
) -> None:
    """Turns crash reports into road networks and scenarios that a simulator runs."""


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
    """Run every case of a folder under one or several configs; run again to go on where it stopped."""
    from flows.case_files.find_cases import cases_in

    judged = [f"judge.name={judge}"] if judge else []
    _batch(cases_in(cases), config, [*(overrides or ()), *judged, *_encoded(encoding)], out, jobs, fresh)


def _encoded(encoding: str) -> list[str]:
    """The option as an override; the config's check tells a wrong value and a writer that has no choice."""
    return [f"scenario_writer.encoding={encoding}"] if encoding else []


def _batch(
    found: Sequence[object],
    config: list[Path] | None,
    overrides: list[str] | None,
    out: Path,
    jobs: int | None,
    fresh: bool,
) -> None:
    """Check everything, then start."""
    from flows.batch import plan_batch as batches

    made = batches.batch_of(found, settings.configs_or_default(config), out, overrides or (), jobs, fresh)  # type: ignore[arg-type]
    from flows.batch import run_batch

    raise typer.Exit(_carry_out(made, lambda watch: run_batch.evaluate(made, watch.ended, on_turn=watch.turn))[0])


def _carry_out(made: Batch, work: Callable[[Watch], Result]) -> tuple[int, Result]:
    """Work under a progress bar, told at its end; the exit code and what the work returned."""
    from flows.batch import config_folder, progress_bar, summary

    for config in made.configs:
        if line := config_folder.replaced(made.out / config.name, config):
            sys.stderr.write(f"sgcad: note: {line}\n")
    tally = summary.Tally(made)
    stopped = _heed_interrupts()
    try:
        with progress_bar.watching(tally) as watch:
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
    truth: Annotated[Path | None, typer.Option("--truth", help="A folder with what is true of the cases.")] = None,
    overrides: Overrides = None,
    out: Out = DEFAULT_OUT,
    jobs: Jobs = None,
    fresh: Fresh = False,
    hosts: Annotated[str, typer.Option("--hosts", help="fsspec address where hosts meet (docs/scale.md).")] = "",
    deployment: Annotated[str, typer.Option(help="What the hosts' workers serve.")] = "shard/shard",
) -> None:
    """Compare arms over the same cases: stages that arms share are computed once.

    A study begun before goes on by its name alone, with the cases and overrides it was begun with.
    """
    from flows.deploy import hosts_preflight
    from flows.study import plan, resume, run_study, spec

    known = resume.before(file, out)
    given = resume.cases_of(known, tuple(cases or ())), truth or known.truth, overrides or known.overrides
    study = spec.load_study(known.file)
    made = plan.plan(study, out, cases=given[0], truth=given[1], overrides=given[2], jobs=jobs, fresh=fresh)
    if hosts:
        meeting = hosts_preflight.Away(hosts, deployment)
        code, submitted = _carry_out(made.batch, lambda watch: hosts_preflight.run(made, meeting, watch.ended))
        typer.echo(hosts_preflight.resubmitted_lines(submitted))
        raise typer.Exit(code)
    code, cost = _carry_out(made.batch, lambda watch: run_study.run(made, watch.ended, watch.turn))
    typer.echo(run_study.cost_line(made, cost))
    raise typer.Exit(code)


@app.command()
def check(
    config: Annotated[Path, typer.Argument(help="A YAML, of a config or of a study.")],
    overrides: Overrides = None,
) -> None:
    """Check a config, or all arms of a study, without starting anything."""
    from flows.catalogue import describe_config
    from flows.study import plan, spec
    from sgcad_core.config import load

    if study_file := spec.study_in(config):
        typer.echo(plan.described(spec.load_study(study_file), tuple(overrides or ())))
        return
    describe_config(load(config, tuple(overrides or ())))


@app.command()
def play(
    file: Annotated[Path, typer.Argument(help="An OpenSCENARIO file (.xosc), or one with a parameter distribution.")],
    out: Out = Path("played"),
    given: Annotated[list[str] | None, typer.Option("--set", help="NAME=VALUE for a parameter of the file.")] = None,
    maps: Annotated[list[Path] | None, typer.Option("--maps", help="A folder with maps that are not there.")] = None,
    sets: Annotated[int, typer.Option(help="Most parameter sets that are played.", min=1)] = 20,
    until: Annotated[float, typer.Option(help="Seconds after which it is cut.", min=0.1, max=300)] = 300.0,
) -> None:
    """Play any scenario file: trajectories.csv, player.html, contacts.json, metrics.json, played.json."""
    from flows.player import play_any_xosc

    for folder in play_any_xosc.play(file, out, given or (), maps or (), sets, until):
        typer.echo(str(folder / "player.html"))


@app.command()
def explain(
    case: Annotated[Path, typer.Argument(help="A case's folder in a run, or a report, which is read on the spot.")],
) -> None:
    """What was read of a report: each sentence with its facts, what follows from them, what is assumed."""
    from flows.case.explain import explain as account

    typer.echo(escape_plain(account(case)))


@app.command()
def doctor(out: Out = DEFAULT_OUT) -> None:
    """Look whether everything needed is there and works."""
    from flows.doctor import examine

    raise typer.Exit(0 if examine(out) else 1)


app.command()(drive)
app.command()(vary)
app.command()(table)
app.command()(report)
app.command()(score)
app.command()(revise)


def main() -> None:
    """The command."""
    guarded(app)


def guarded(command: Callable[[], object]) -> None:
    """The edge: every error becomes one message on stderr and an exit code."""
    try:
        command()
    except SgcadError as fault:
        _end(str(fault), 2)
    except KeyboardInterrupt:
        _interrupted()
    except Exception as fault:  # noqa: BLE001 - the command line's edge
        traceback.print_exception(fault)
        _end(f"unexpected {type(fault).__name__}: {fault}; `sgcad doctor` may tell why", 1)


def _end(message: str, code: int) -> None:
    sys.stderr.write(f"sgcad: error: {escape_plain(message)}\n")
    _leave(code)


def _heed_interrupts() -> threading.Event:
    """The first Ctrl-C stops the batch in order, for 5 s at most (a model may be thinking); the second at once.

    The event that comes back is set from the first on.
    """
    stopped = threading.Event()
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return stopped  # whoever started us wants Ctrl-C ignored

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
    """Leave at once: threads may still wait for a model or a simulator, and their processes must not outlive us."""
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

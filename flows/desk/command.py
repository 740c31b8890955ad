"""`sgcad desk`: `open` serves finished cases to a browser, `export` writes the facts that people changed as data.

`sgcad desk RUNS` means `sgcad desk open RUNS`. Everything heavy is imported inside, so that --help is quick.
"""

from __future__ import annotations

import secrets
import socket
import sys
import threading
import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from sgcad_core.errors import ConfigError

if TYPE_CHECKING:
    import uvicorn

    from flows.desk.guard import Gate

DEFAULT_RUNS = Path("runs")
DEFAULT_PORT = 8321
EVERYWHERE = ("0.0.0.0", "::", "")  # noqa: S104 - what is guarded against


class OpensFolders(TyperGroup):
    """A group of commands that takes a folder in place of a command as an argument of `open`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read `desk RUNS --open` as `desk open RUNS --open`, and `desk` alone as `desk open`."""
        first = args[0] if args else ""
        opens = first not in self.commands and first not in ctx.help_option_names
        return super().parse_args(ctx, ["open", *args] if opens else args)


desk_app = typer.Typer(
    cls=OpensFolders,
    help="Look at finished cases and correct them. `sgcad desk RUNS` is short for `sgcad desk open RUNS` and takes the "
    "same options.",
)


@desk_app.command("open")
def open_desk(
    runs: Annotated[
        Path, typer.Argument(help="A results folder, the --out of `sgcad run` or `evaluate`.")
    ] = DEFAULT_RUNS,
    host: Annotated[
        str, typer.Option(help="Address to listen on; beyond this machine a token is required.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Port; 0 selects a free one.", min=0, max=65535)] = DEFAULT_PORT,
    names: Annotated[
        list[str] | None,
        typer.Option("--name", help="A further host name that the desk answers to; may be given several times."),
    ] = None,
    token: Annotated[str, typer.Option(envvar="SGCAD_DESK_TOKEN", help="Token to require, also on this machine.")] = "",
    open_browser: Annotated[bool, typer.Option("--open", help="Open a browser.")] = False,
    mlflow: Annotated[str, typer.Option(help="Address of MLflow's pages, such as http://127.0.0.1:5000.")] = "",
    prefect: Annotated[str, typer.Option(help="Address of Prefect's pages, such as http://127.0.0.1:4200.")] = "",
) -> None:
    """Show the cases of a results folder in a browser, to see which to trust and to correct the others.

    Ctrl-C ends it; every change is on disk.
    """
    serve(DeskOptions(runs, host, port, tuple(names or ()), token, open_browser, mlflow, prefect))


@desk_app.command()
def export(
    runs: Annotated[Path, typer.Argument(help="The folder of one config's cases, such as runs/template.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for pairs, truth files and training rows.")],
) -> None:
    """Export cases corrected by people: pairs (read, corrected), truth files for `sgcad score`, training rows."""
    from flows.desk.export_edits import export as write

    for line in write(runs, out):
        typer.echo(line)


@dataclass(frozen=True)
class DeskOptions:
    """The arguments of `sgcad desk open`."""

    runs: Path
    host: str
    port: int
    names: tuple[str, ...] = ()
    token: str = ""
    open_browser: bool = False
    mlflow: str = ""
    prefect: str = ""


def serve(asked: DeskOptions) -> None:
    """Serve until Ctrl-C. Raises ConfigError: no such folder, a port in use, a wrong address."""
    root, pages = _folder(asked.runs), (_page(asked.mlflow, "--mlflow"), _page(asked.prefect, "--prefect"))
    from flows.case_files.case_links import noted_desk
    from flows.desk.app import application  # takes a second or two: after the folder is checked

    gate = gate_of(asked)
    app = application(root, gate, *pages)
    with socket_at(asked.host, asked.port) as listening:
        address = address_of(asked.host, listening.getsockname()[1], gate.token)
        sys.stdout.write(f"The desk over {root} is at\n\n  {address}\n\nCtrl-C ends it.\n")
        sys.stdout.flush()
        if asked.open_browser:
            threading.Timer(0.5, webbrowser.open, (address,)).start()
        with noted_desk(root, address_of(asked.host, listening.getsockname()[1], "").rstrip("/")):
            server_of(app).run(sockets=[listening])


def server_of(app: object) -> uvicorn.Server:
    """The desk's server: one process, without logs and web sockets."""
    import uvicorn

    config = uvicorn.Config(
        app,  # type: ignore[arg-type]
        log_level="warning", access_log=False, server_header=False, timeout_graceful_shutdown=3, proxy_headers=False,
        ws="none",
    )  # fmt: skip
    return uvicorn.Server(config)


def gate_of(asked: DeskOptions) -> Gate:
    """Conditions of access: beyond this machine a token is needed, which is generated where none is given."""
    from flows.desk.guard import LOOPBACK, Gate

    local = asked.host in LOOPBACK
    if asked.token and len(asked.token) < 16:
        raise ConfigError(
            f"--token: {len(asked.token)} characters can be guessed; give 16 or more, or none to have one generated"
        )
    names = {*LOOPBACK, *(name.lower() for name in asked.names)}
    if not local:
        names |= {asked.host.lower(), socket.gethostname().lower(), socket.getfqdn().lower()}
    token = asked.token or ("" if local else secrets.token_urlsafe(24))
    return Gate(names=frozenset(names), token=token, any_address=not local)


def address_of(host: str, port: int, token: str) -> str:
    """The desk's address in a browser."""
    name = socket.gethostname() if host in EVERYWHERE else f"[{host}]" if ":" in host else host
    return f"http://{name}:{port}/" + (f"?token={token}" if token else "")


def _folder(runs: Path) -> Path:
    if runs.is_dir():
        if (runs / "result.json").is_file():
            raise ConfigError(
                f"{runs}: is one case; give the results folder above it, such as {runs.resolve().parent.parent}"
            )
        return runs.resolve()
    remedy = (
        "make results first, such as with `make demo` or `sgcad run REPORT`, or name their folder: sgcad desk FOLDER"
    )
    raise ConfigError(f"{runs}: no such folder; {remedy}")


def _page(given: str, option: str) -> str:
    from flows.case_files.case_links import address

    if given and not address(given):
        raise ConfigError(f"{option} {given}: no web address; give one such as http://127.0.0.1:5000")
    return address(given)


def socket_at(host: str, port: int) -> socket.socket:
    """A listening socket. Raises ConfigError naming the port and what to do."""
    try:
        family = socket.getaddrinfo(host or None, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        listening = socket.socket(family[0], socket.SOCK_STREAM)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(family[4][:2])
    except OSError as fault:
        why = fault.strerror or str(fault)
        raise ConfigError(
            f"--host {host} --port {port}: cannot listen ({why}); --port 0 selects a free port"
        ) from fault
    listening.listen(64)
    return listening

"""What strangers wrote reaches the terminal as text."""

import io

from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from flows import command_end
from flows.results.writing import _no_formula
from flows.terminal import escape
from sgcad_core.errors import BadInput


@given(st.text())
def test_no_control_character_and_no_markup_passes(text):
    out = io.StringIO()
    Console(file=out, force_terminal=True, color_system=None, width=10_000, soft_wrap=True).print(escape(text), end="")
    assert not {c for c in out.getvalue() if (ord(c) < 32 and c != "\n") or 0x7F <= ord(c) < 0xA0}


def test_an_escape_sequence_is_seen():
    assert escape("a\x1b[31mb[bold]") == "a\ufffd[31mb\\[bold]"


def test_a_fault_that_names_a_strangers_file_reaches_the_terminal_as_text(capsys, monkeypatch):
    def fails():
        raise BadInput("a\x1b[31mb.txt: cannot be read")

    monkeypatch.setattr(command_end, "leave", lambda code: None)
    command_end.guarded(fails)
    assert capsys.readouterr().err == "sgcad: error: a\ufffd[31mb.txt: cannot be read\n"


def test_a_spreadsheet_computes_no_name():
    assert [_no_formula(v) for v in ("=1+1", "@a", "-2", "mini", -2.0)] == ["'=1+1", "'@a", "'-2", "mini", -2.0]

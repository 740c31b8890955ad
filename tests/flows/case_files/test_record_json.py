"""Packed records come back equal, and hostile bytes are told apart without running or building anything."""

import json
import math
import pickle
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flows.case_files.record_json import Unpackable, pack, unpack
from flows.case_files.step_keys import content_of
from sgcad_core.asking.refine import Call, Turn
from sgcad_core.case.records import (
    Attempt,
    CrashReport,
    Diagram,
    Execution,
    Finding,
    Generation,
    Hold,
    ObservedContact,
    Query,
    Token,
    Trajectory,
)
from sgcad_core.errors import Refused

PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text() | st.binary(),
    lambda inner: st.lists(inner) | st.tuples(inner, inner) | st.dictionaries(st.text(), inner),
    max_leaves=12,
)


@given(PLAIN)
def test_plain_values_come_back_equal_and_of_the_same_type(value):
    assert repr(unpack(pack(value))) == repr(value)


@given(st.lists(st.floats(width=64), max_size=40))
def test_arrays_come_back_bit_by_bit(numbers):
    made = np.array(numbers, dtype=np.float64)
    back = unpack(pack(made))
    assert back.dtype == np.float64
    assert back.tobytes() == made.tobytes()


def _track():
    t = np.arange(3) * 0.05
    return Trajectory(actor="V1", t_s=t, x_m=t, y_m=-t, heading_rad=t, speed_mps=t + 1)


HOLD = Hold(items="vehicles", key="id", values=("V1",), either=({"maneuver": ("stopped", 1)},), at_least=1)
TURN = Turn(
    Attempt(
        stage="road",
        number=2,
        held=(HOLD,),
        findings=(Finding(source="s", what="w", holds=(HOLD,)),),
        generation=Generation(
            text="{}", tokens=(Token(text="{", logp_with_context=-math.inf),), grounding={"a.b": 1.5}, seconds=0.5
        ),
    ),
    refused=Refused("too thin", ["lanes"]),
    calls=(Call(Query(task="t", answer_schema={"type": "object", "enum": [1, "a"]}), Generation(text="x")),),
)


@pytest.mark.parametrize(
    "value",
    [
        (CrashReport(case="c", narrative="n", diagrams=(Diagram(png=b"\x89", width_px=1, height_px=2),)), 0.25),
        (CrashReport(case="c", narrative="n", coded={"a": [1, {"b": None}]}), 0.25),
        (
            Execution(
                simulator="s",
                trajectories=(_track(),),
                contact=ObservedContact(actor="V1", other="V2", actor_area="front", other_area="back", t_s=1.0),
            ),
            1.0,
        ),
    ],
    ids=["report", "coded report", "execution"],
)
def test_records_come_back_equal_in_content(value):
    assert content_of(unpack(pack(value))) == content_of(value)


def test_a_turn_comes_back_with_its_attempt_its_calls_and_its_refusal():
    (turn,) = unpack(pack([TURN]))
    assert (turn.attempt, turn.calls, turn.artifact) == (TURN.attempt, TURN.calls, None)
    assert (turn.refused.reason, turn.refused.missing) == ("too thin", ("lanes",))


def _packed(told):
    return zlib.compress(json.dumps(told).encode())


@pytest.mark.parametrize(
    "packed",
    [
        b"",
        b"no zlib",
        pickle.dumps({"a": 1}),
        zlib.compress(pickle.dumps({"a": 1})),
        zlib.compress(b"{"),
        zlib.compress(b"[" * 100_000 + b"]" * 100_000),
        _packed([1]),
        _packed({"no": "kind"}),
        _packed({"~": "Popen", "fields": {"args": "id"}}),
        _packed({"~": "Record", "fields": {"x": 1}}),
        _packed({"~": "CrashReport", "fields": {"case": 1, "narrative": "n"}}),
        _packed({"~": "CrashReport", "fields": {"case": "c", "narrative": "n", "more": 1}}),
        _packed({"~": "Turn", "fields": {"attempt": "none"}}),
        _packed({"~": "array", "shape": [10**12], "data": ""}),
        _packed({"~": "array", "shape": [1], "data": "!"}),
        _packed({"~": "bytes", "data": 7}),
        _packed({"~": "dict", "items": [[{"~": "list", "items": []}, 1]]}),
        pack(1)[:-2],
    ],
)
def test_what_was_not_packed_here_is_told_apart(packed):
    with pytest.raises(Unpackable, match=r"packed value|bare list|cut short"):
        unpack(packed)


def test_a_bomb_is_not_blown_up(monkeypatch):
    monkeypatch.setattr("flows.case_files.record_json.MAX_BYTES", 1_000_000)
    with pytest.raises(Unpackable, match="more than 1000000 bytes"):
        unpack(zlib.compress(b" " * 50_000_000))


@pytest.mark.parametrize("value", [object(), {1, 2}, [print], ValueError("x"), type("CrashReport", (), {})()])
def test_a_strangers_object_is_not_packed(value):
    with pytest.raises(TypeError, match="only the project's own records"):
        pack(value)

"""The index on a real LanceDB: what is found, what an addition changes, what a killed one leaves."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plugins.retriever.knowledge import store
from plugins.retriever.knowledge.chunk import Chunk, split_names
from plugins.retriever.knowledge.embedders import unit
from plugins.retriever.knowledge.manifest import MANIFEST
from plugins.retriever.knowledge.search import Index, fuse
from plugins.retriever.lancedb import LanceDB
from sgcad_core.errors import ConfigError

ROOT = Path(__file__).resolve().parents[3]


def quiet(count):
    assert count >= 0


def chunk(name, text, kind="api", tasks=("road",), **more):
    return Chunk(id=name, kind=kind, tasks=tasks, title=name, text=text, **more)


CHUNKS = [
    chunk("api/a", "numLanes is the number of lanes of an edge"),
    chunk("api/b", "a zebra crossing for pedestrians", tasks=("scenario",)),
    chunk("example/c", "a zebra stood on the road", kind="example", tasks=("road", "scenario")),
    chunk("api/it's", "quotes ' and \" and -- are only text"),
]


class Letters:
    """A real embedder, if a poor one: how often each letter occurs."""

    name = "letters/1"

    def __init__(self):
        self.texts = 0

    def embed(self, texts):
        self.texts += len(texts)
        return unit([[text.lower().count(chr(97 + i)) for i in range(26)] for text in texts])


@pytest.fixture
def folder(tmp_path):
    store.build(tmp_path / "kb", CHUNKS, None, quiet)
    return tmp_path / "kb"


def files_of(folder):
    return {str(f.relative_to(folder)): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}


def ids(hits):
    return [hit.id for hit in hits]


def test_full_text_finds_names_by_the_words_they_are_made_of(folder):
    assert ids(LanceDB(folder=folder).search("num lanes", 1)) == ["api/a"]
    assert "lane change" in split_names("LaneChange and lane_change").lower()


def test_kinds_and_task_narrow_the_search(folder):
    index = LanceDB(folder=folder)
    assert set(ids(index.search("zebra"))) == {"api/b", "example/c"}
    assert ids(index.search("zebra", kinds=["example"])) == ["example/c"]
    assert ids(index.search("zebra", kinds=["api"], task="scenario")) == ["api/b"]
    assert ids(index.search("zebra", kinds=["api"], task="road")) == []


def test_passages_come_kind_by_kind_in_the_order_of_the_field(folder):
    retriever = LanceDB(folder=folder, kinds=("example", "api"), per_kind=1)
    found = retriever.retrieve("zebra", "scenario")
    assert [(p.id, p.kind) for p in found] == [("example/c", "example"), ("api/b", "api")]
    assert found[0].text == "a zebra stood on the road"
    assert found[0].score > 0


def test_an_unknown_task_is_an_error(folder):
    with pytest.raises(ConfigError, match="serves the tasks road, scenario, not 'weather'"):
        LanceDB(folder=folder).retrieve("zebra", "weather")


@given(st.text(max_size=200))
@settings(max_examples=40, deadline=None)
def test_any_text_is_a_query(any_text):
    assert len(SHARED().search(any_text, 3)) <= 3


def SHARED(made=[]):  # noqa: B006 - one index for all examples of the property
    if not made:
        import tempfile

        folder = Path(tempfile.mkdtemp()) / "kb"
        store.build(folder, CHUNKS, None, quiet)
        made.append(LanceDB(folder=folder))
    return made[0]


@pytest.mark.parametrize("empty", ["", "   ", "?!", "the of and"])
def test_a_query_without_a_word_finds_nothing(folder, empty):
    assert LanceDB(folder=folder).search(empty) == []


def test_quotes_in_names_are_harmless(folder):
    changed = chunk("api/it's", "now it says something else: giraffe")
    after = store.add(folder, [changed], None, quiet)
    assert after.chunks == len(CHUNKS)
    assert ids(LanceDB(folder=folder).search("giraffe")) == ["api/it's"]
    assert ids(LanceDB(folder=folder).search("quotes")) == []


def test_adding_again_changes_no_byte(folder):
    before = files_of(folder)
    manifest = store.add(folder, [*CHUNKS, *CHUNKS], None, quiet)
    assert manifest.number == 1
    after = files_of(folder)
    after.pop(".lock")
    assert after == before


def test_an_addition_is_found_and_gets_a_version_of_its_own(folder):
    first = LanceDB(folder=folder)
    assert ids(first.search("giraffe")) == []
    after = store.add(folder, [chunk("api/new", "a giraffe")], None, quiet)
    assert (after.tag, after.chunks) == ("kb-v2", len(CHUNKS) + 1)
    second = LanceDB(folder=folder)
    assert ids(second.search("giraffe")) == ["api/new"]
    assert ids(first.search("giraffe")) == [], "an open index stays what it was"
    assert second.stamp == after.stamp != f"kb-v1-{after.content}"


def test_equal_knowledge_has_an_equal_fingerprint_however_it_came(tmp_path):
    one = store.build(tmp_path / "one", CHUNKS, None, quiet)
    store.build(tmp_path / "two", CHUNKS[2:], None, quiet)
    two = store.add(tmp_path / "two", CHUNKS, None, quiet)
    assert one.content == two.content


def test_a_killed_addition_is_not_read_and_does_no_harm(folder):
    import lancedb

    table = lancedb.connect(folder).open_table(store.TABLE)
    table.add(store._rows([chunk("api/half", "a giraffe")], None, table.schema))
    assert ids(LanceDB(folder=folder).search("giraffe")) == []
    after = store.add(folder, [chunk("api/whole", "an okapi")], None, quiet)
    assert after.chunks == len(CHUNKS) + 1
    assert ids(LanceDB(folder=folder).search("giraffe okapi")) == ["api/whole"]


@pytest.mark.slow
def test_a_build_killed_halfway_leaves_the_index_before(folder):
    before = files_of(folder)
    code = f"""
import time
from pathlib import Path
from plugins.retriever.knowledge import store
from plugins.retriever.knowledge.chunk import Chunk
def slow():
    for i in range(10**6):
        if i == store.BATCH + 1: print("half", flush=True); time.sleep(60)
        yield Chunk(id=str(i), kind="api", tasks=("road",), title="t", text="giraffe")
store.build(Path({str(folder)!r}), slow(), None, lambda n: None)
"""
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, cwd=ROOT)
    assert process.stdout.readline() == b"half\n"
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert files_of(folder) == before
    assert ids(LanceDB(folder=folder).search("giraffe")) == []


def test_a_build_replaces_an_index_but_nothing_else(folder, tmp_path):
    assert store.build(folder, CHUNKS[:1], None, quiet).chunks == 1
    precious = tmp_path / "precious"
    precious.mkdir()
    (precious / "thesis.txt").write_text("years of work")
    with pytest.raises(ConfigError, match="holds something that is no index"):
        store.build(precious, CHUNKS, None, quiet)
    assert (precious / "thesis.txt").read_text() == "years of work"
    assert [p.name for p in tmp_path.iterdir() if "partial" in p.name] == []


def test_a_missing_index_names_the_command_that_builds_it(tmp_path):
    with pytest.raises(ConfigError, match=r"no knowledge base in .*: build it with `sgcad index build --out"):
        LanceDB(folder=tmp_path / "none").retrieve("zebra", "road")


@pytest.mark.parametrize(
    ("text", "says"), [("{", "unreadable"), ('{"number": 1}', "unreadable"), (None, "format 99, this version reads 1")]
)
def test_a_damaged_manifest_is_an_error_with_a_remedy(folder, text, says):
    known = json.loads((folder / MANIFEST).read_text())
    (folder / MANIFEST).write_text(text or json.dumps(known | {"format": 99}))
    with pytest.raises(ConfigError, match=f"{says}.*build the index anew"):
        LanceDB(folder=folder).search("zebra")


def test_a_damaged_table_is_an_error_with_a_remedy(folder):
    for file in (folder / "chunks.lance" / "_versions").iterdir():
        file.unlink()
    with pytest.raises(ConfigError, match=r"broken .*build it anew"):
        LanceDB(folder=folder).search("zebra")


def test_an_index_can_be_moved(folder, tmp_path):
    os.rename(folder, tmp_path / "elsewhere")
    assert len(LanceDB(folder=tmp_path / "elsewhere").search("zebra")) == 2


def test_vectors_find_what_shares_no_word_and_full_text_alone_reads_the_same_index(tmp_path):
    letters = Letters()
    store.build(tmp_path / "kb", CHUNKS, letters, quiet)
    index = Index(tmp_path / "kb", letters)
    assert ids(index.search("zebrazebra", 4))
    assert ids(Index(tmp_path / "kb", None).search("zebrazebra", 4)) == []
    assert ids(Index(tmp_path / "kb", None).search("zebra", 4)) != []


def test_only_what_is_new_is_embedded(tmp_path):
    letters = Letters()
    store.build(tmp_path / "kb", CHUNKS, letters, quiet)
    done = letters.texts
    store.add(tmp_path / "kb", [*CHUNKS, chunk("api/new", "okapi")], letters, quiet)
    assert letters.texts == done + 1


def test_vectors_of_two_embedders_are_never_mixed(tmp_path):
    store.build(tmp_path / "kb", CHUNKS, Letters(), quiet)
    with pytest.raises(ConfigError, match="built with embedder 'letters/1', not 'none'"):
        store.add(tmp_path / "kb", CHUNKS, None, quiet)
    other = Letters()
    other.name = "other/1"
    with pytest.raises(ConfigError, match="built with embedder 'letters/1', not 'other/1'"):
        Index(tmp_path / "kb", other)


@given(st.lists(st.lists(st.sampled_from("abcdefgh"), unique=True), min_size=1, max_size=3))
def test_fusion_prefers_what_stands_higher_everywhere(lists):
    scores = fuse(lists, (1.5, 1.0, 1.0))
    assert set(scores) == {name for found in lists for name in found}
    for a in scores:
        for b in scores:
            if all(a in found and (b not in found or found.index(a) < found.index(b)) for found in lists):
                assert scores[a] > scores[b]


def test_unit_rows_have_length_one_and_zero_stays():
    rows = unit([[3, 4], [0, 0]])
    assert np.allclose(rows, [[0.6, 0.8], [0, 0]])
    assert rows.dtype == np.float32


@pytest.mark.slow
def test_memory_does_not_grow_with_the_index(tmp_path):
    import psutil

    def many(count):
        rng = np.random.default_rng(0)
        for i in range(count):
            words = " ".join(f"w{n}" for n in rng.integers(0, 5000, 40))
            yield chunk(f"api/{i}", words, data="x" * 2000)

    peak = []
    started = time.perf_counter()
    store.build(tmp_path / "kb", many(20_000), None, lambda n: peak.append(psutil.Process().memory_info().rss))
    assert time.perf_counter() - started < 120
    assert (max(peak[40:]) - peak[20]) / 2**20 < 250, "MiB; the chunks themselves take 50 MiB"

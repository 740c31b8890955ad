"""Tables: figures, n, intervals, tests against the reference, and the published ones apart."""

import csv
import io
import itertools
import re
from pathlib import Path

import pytest
from rich.console import Console

from flows.case_files.folder_cases import write_left_out
from flows.results import measures, writing
from flows.results.layouts import LAYOUTS
from flows.results.reading import load_study as load_results
from flows.results.table import refusal_counts, tables_of
from flows.study.published import publication
from flows.study_file.spec import load_study
from sgcad_core import settings
from sgcad_core.errors import ConfigError

PAPER = Path(__file__).resolve().parents[4] / "shared" / "paper" / "sg-cadvlm.tex"
LEVEL = "report_reader.robustness_level"
TWO = {
    "a": {f"c{k}": {} for k in range(8)},
    "b": {f"c{k}": ({"status": "refused"} if k < 6 else {"net": "<net/>"}) for k in range(8)},
}


def cells(tables, key):
    (table,) = [t for t in tables.tables if t.key == key]
    return {(row.name, name): cell for row in table.rows for name, cell in row.cells.items()}


def test_shares_and_means_come_from_the_cases_with_their_n(tables):
    made = tables(TWO)
    generation = cells(made, "generation")
    assert (generation["a", "generated"].value, generation["a", "generated"].n) == (100.0, 8)
    assert (generation["b", "refused"].value, generation["b", "generated"].value) == (75.0, 25.0)
    assert generation["b", "as_declared"].n == 2
    paper = cells(made, "criticality_paper")
    assert (paper["a", "p_ttc"].value, paper["b", "p_ttc"].n) == (0.5, 2)
    assert ("a", "p_pet") not in paper  # no case has one: the column is left out
    assert cells(made, "criticality_exact")["a", "x_high"].value == 100.0


def test_a_case_without_output_is_wrong_in_both_readings_of_a_network_error(tables):
    made = tables(TWO)
    assert cells(made, "network_wrong")["b", "intersections_wrong"].value == 100.0
    assert cells(made, "network_mean")["b", "lanes_error"].value == 100.0
    assert cells(made, "network_wrong")["a", "lanes_wrong"].value == 0.0


def test_arms_are_tested_against_the_reference_on_common_cases(tables):
    made = tables(TWO, about={"reference": "a"})
    generation = cells(made, "generation")
    assert generation["a", "generated"].p is None
    assert generation["b", "generated"].p == pytest.approx(2 / 2**6)
    assert cells(made, "network_mean")["b", "lanes_error"].p == pytest.approx(2 / 2**8)
    assert cells(made, "criticality_paper")["b", "p_ttc"].p == 1.0


def test_p_values_are_corrected_for_the_number_of_arms(tables):
    alone = cells(tables(TWO), "generation")["b", "generated"].p
    three = cells(tables(TWO | {"c": TWO["a"]}), "generation")["b", "generated"].p
    assert three == pytest.approx(2 * alone)


def test_a_study_half_done_says_so_and_stands_on_what_is_there(tables):
    made = tables({"a": {"c0": {}, "c1": {}}, "b": {"c1": {}}}, cases=["c0", "c1", "c2"])
    assert made.remarks[0] == "3 of 6 runs are done (2 arms, 3 cases)."
    assert tables({"a": {"c0": {}}}).remarks[0] == "1 of 1 runs are done (1 arm, 1 case)."
    (table,) = [t for t in made.tables if t.key == "generation"]
    assert [(r.done, r.of) for r in table.rows] == [(2, 3), (1, 3)]
    assert table.rows[1].cells["generated"].n == 1


def test_what_a_batch_left_out_is_a_remark(tables):
    folder = tables(TWO).study.folder
    for arm in TWO:
        write_left_out(folder / arm, ("cases/notes.docx",))
    assert tables_of(load_results(folder)).remarks[-1].startswith("left out, 1 beside the cases: cases/notes.docx")


def test_tables_in_which_arms_differ_come_first_and_the_others_are_named(tables):
    made = tables({"a": {"c1": {}, "c2": {}}, "b": {"c1": {"ttc": 0.5}, "c2": {"ttc": 2.5}}})
    alike = [table.alike for table in made.tables]
    assert alike == sorted(alike)
    assert not made.tables[0].alike
    assert made.tables[-1].title in made.remarks[1]
    assert not any(table.alike for table in tables({"a": {"c1": {}}}).tables)


def test_an_arm_that_has_not_begun_has_empty_cells(tables):
    made = tables({"a": {"c0": {}}, "b": {}})
    (table,) = [t for t in made.tables if t.key == "generation"]
    assert table.rows[1].cells["generated"] is None
    assert "-" in shown(made)


def test_without_truth_its_tables_are_left_out_and_it_is_said(tables):
    made = tables(TWO, truth=False)
    assert not {"network_wrong", "network_mean", "truth"} & {t.key for t in made.tables}
    assert any("No ground truth" in r for r in made.remarks)


def test_files_are_counted_as_the_papers_error_rate(tables):
    made = tables({"a": {"c0": {"faults": ["netconvert"]}, "c1": {}}})
    assert cells(made, "generation")["a", "file_errors"].value == pytest.approx(50.0)


# ------------------------------------------------------------------ refusals
def test_precision_and_recall_of_refusals_follow_from_the_levels(tables):
    refused, made = {"status": "refused"}, {}
    ends = {"full": [made, refused], "blur_weak": [made, made], "critical_depletion": [refused, made],
            "total_sparsity": [refused, refused]}  # fmt: skip
    runs = {level: {f"c{k}": change for k, change in enumerate(changes)} for level, changes in ends.items()}
    named = {level: {"factors": {LEVEL: level}} for level in ends}
    tables = tables(runs, arms=named)
    found = cells(tables, "refusals")
    ((row, _), *_) = found
    assert found[row, "refusal_precision"].value == pytest.approx(75.0)  # 3 of 4 refused
    assert found[row, "refusal_recall"].value == pytest.approx(75.0)  # 3 of 4 that should be
    assert found[row, "wrongly_refused"].value == pytest.approx(25.0)  # 1 of 4 that should not
    (table,) = [t for t in tables.tables if t.key == "robustness"]
    assert [r.name for r in table.rows] == list(ends)


def test_only_what_is_declared_should_be_refused():
    assert refusal_counts([("modal_conflict", 1.0), ("critical_depletion", 1.0), ("semantic_noise", 0.0)]) == {
        "rightly": 1.0, "wrongly": 1.0, "refusals": 2.0, "due": 1.0, "carried": 2.0,
    }  # fmt: skip


# ------------------------------------------------------------------ published
def test_published_figures_never_enter_ours(tables):
    with_them = tables(TWO, arms={"a": {"published": "tbg"}})
    ours = {k: (c.value, c.n, c.interval) for k, c in cells(with_them, "network_wrong").items()}
    (table,) = [t for t in with_them.tables if t.key == "network_wrong"]
    assert table.rows[0].published["intersections_wrong"].value == 22.0
    assert table.rows[1].published == {}
    assert ours["a", "intersections_wrong"][:2] == (0.0, 8)
    assert "published" in shown(with_them)


def test_every_published_figure_belongs_to_a_measure_and_a_table():
    known = {m.name for layout in LAYOUTS for m in layout.measures}
    figures = [(n, f) for row in publication().rows.values() for n, f in row.figures.items()]
    assert {name for name, _ in figures} <= known
    assert {f.table for _, f in figures} <= {1, 2, 3, 4, 5}


def test_an_unknown_published_row_is_told_with_the_known_ones(tables):
    with pytest.raises(ConfigError, match=r"published: 'tgb' is no row .*tbg"):
        tables(TWO, arms={"a": {"published": "tgb"}})


@pytest.mark.skipif(not PAPER.is_file(), reason="the paper's text is not here")
def test_every_published_figure_stands_in_its_table_of_the_paper():
    found = re.findall(r"\\begin\{table\}.*?\\end\{table\}", PAPER.read_text(), re.DOTALL)
    for row in publication().rows.values():
        for name, figure in row.figures.items():
            share = {"p_collision_any": 100.0}.get(name, 1.0)
            numbers = {float(n) for n in re.findall(r"\d+\.\d+", found[figure.table - 1])}
            assert round(figure.value / share, 4) in numbers, (row.name, name)


# ------------------------------------------------------------------ written out
def shown(tables, width=120):
    out = io.StringIO()
    writing.show(tables, Console(file=out, width=width, emoji=False, highlight=False))
    return out.getvalue()


@pytest.mark.parametrize("width", [80, 120, 200])
def test_text_fits_the_terminal_and_cuts_nothing(tables, width):
    text = shown(tables(TWO, arms={"a": {"published": "omnitester"}}), width)
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    labels = [m.label for layout in LAYOUTS if not layout.by_level for m in layout.measures if m.name != "p_pet"]
    missing = [
        label
        for label in labels
        if label not in text and label not in ("PET", "lanes total", "legs", "relative heading")
    ]
    assert not missing


def test_csv_has_one_figure_a_line_in_full_precision(tables):
    made = tables(TWO | {"c": {"c0": {}, "c1": {"status": "failed"}, "c2": {}}}, arms={"a": {"published": "tbg"}})
    lines = list(csv.DictReader(io.StringIO(writing.as_csv(made))))
    (one,) = [x for x in lines if (x["table"], x["arm"], x["measure"]) == ("generation", "c", "generated")]
    assert float(one["value"]) == pytest.approx(200 / 3, rel=1e-14)
    assert (one["n"], one["done"], one["of"], one["published"]) == ("3", "3", "8", "")
    (told,) = [x for x in lines if x["measure"] == "lanes_wrong" and x["arm"] == "a"]
    assert (told["published"], told["published_table"]) == ("36.7", "1")
    assert writing.as_csv(made) == writing.as_csv(made)


def test_latex_escapes_labels_and_sets_rules(tables):
    text = writing.as_latex(tables(TWO, arms={"a": {"label": r"50% of A_1 & {\B} <x>"}}))
    assert r"50\% of A\_1 \& \{\textbackslash{}B\} $<$x$>$" in text
    assert text.count(r"\toprule") == text.count(r"\bottomrule") == text.count(r"\begin{table}")
    for table in re.findall(r"\\toprule(.*?)\\bottomrule", text, re.DOTALL):
        rows = [line.replace(r"\&", "") for line in table.splitlines() if line.endswith(r"\\")]
        assert all(a.count("&") == b.count("&") for a, b in itertools.pairwise(rows))


def test_every_measure_has_one_name():
    every = {m for layout in LAYOUTS for m in layout.measures}
    assert len({m.name for m in every}) == len(every)
    assert {m.kind for m in every} <= {"share", "mean", "ratio"}
    assert measures.GENERATION[0].factor == 100.0


@pytest.mark.parametrize("file", sorted((settings.CONFIGS / "studies").glob("*.yaml")), ids=lambda f: f.stem)
def test_every_study_names_rows_that_are_published(file):
    for arm in load_study(file).arms:
        publication().row(arm.published)


def test_a_study_that_has_not_begun_has_no_tables_and_says_so(tables):
    made = tables({"a": {}, "b": {}}, cases=["c1"])
    assert made.tables == ()
    assert "0 of 2 runs are done" in shown(made)

"""Figures: drawn where there is something to show, left out with a reason where not, and right where they compute."""

import io

import numpy as np
import pytest
from PIL import Image

from flows.results.arm_displacement import displacement_between, displacements_from
from flows.results.measures import NETWORK_WRONG
from flows.results.reading import load_study
from flows.results.report import scenes
from flows.results.report.plots import displacement, pooled, risk, sensitivity, varied_key

ALPHAS = {f"{a}-{seed}": {"factors": {"decoder.alpha": a, "seed": seed}} for a in (0, 0.5, 1) for seed in (0, 1)}


def size(plot):
    return Image.open(io.BytesIO(plot.png)).size


def test_the_varied_key_is_the_one_with_most_numbers_and_never_the_seed():
    assert (
        varied_key([{"decoder.alpha": a, "seed": s, "x": a > 0} for a in (0, 1, 2) for s in range(5)])
        == "decoder.alpha"
    )
    assert varied_key([{"decoder.alpha": a} for a in (0, 1)]) is None
    assert varied_key([{"decoder": "cad"}, {}]) is None


def test_sensitivity_is_drawn_over_the_values_with_seeds_averaged_case_by_case(tables):
    runs = {arm: {"c1": {}, "c2": {"status": "refused" if arm == "1-0" else "generated"}} for arm in ALPHAS}
    made = tables(runs, arms=ALPHAS)
    plot = sensitivity(made)
    assert plot.title == "Sensitivity to decoder.alpha"
    assert size(plot)[0] > size(plot)[1] > 100
    assert pooled(made, ["1-0", "1-1"], NETWORK_WRONG[0]) == [0.0, 0.5]


def test_figures_without_anything_to_show_say_why(tables):
    made = tables({"a": {"c1": {"status": "refused"}}})
    told = [sensitivity(made), risk(made), displacement(made), *scenes.scenes_of(made)]
    assert all(p.png is None and p.reason for p in told)


def test_all_figures_of_cases_are_drawn_even_where_arms_lack_cases(tables):
    made = tables(
        {"a": {"c1": {}, "c2": {}}, "b": {"c1": {"status": "failed"}}}, arms={"a": {"published": "omnitester"}}
    )
    for plot in (risk(made), displacement(made), *scenes.scenes_of(made)):
        assert plot.png is not None, plot.reason
        assert min(size(plot)) > 100


def test_a_coded_label_is_told_in_words_and_markup_in_a_report_is_only_text(tables):
    made = tables(
        {"a": {"c1": {"story": "V1 was traveling east at $40 and $x^_$ mph. V1 struck V2. <b>"}}}, truth=False
    )
    assert scenes.frames(made).png is not None
    assert scenes.networks(made, ["c1"]).png is not None


# ------------------------------------------------------------------ displacement
def moved(folder, angle, by, faster=1.0):
    """The same run in another frame, V1 at another speed before the contact."""
    lines = (folder / "trajectories.csv").read_text().splitlines()
    c, s = np.cos(angle), np.sin(angle)
    for k, line in enumerate(lines[1:], 1):
        t, actor, x, y, heading, speed = line.split(",")
        x, y = float(x), float(y)
        if actor == "V1":
            x = -4.0 + (x + 4.0) * faster
        place = (c * x - s * y + by, s * x + c * y - by)
        lines[k] = f"{t},{actor},{place[0]:.6f},{place[1]:.6f},{float(heading) + angle:.7f},{speed}"
    (folder / "trajectories.csv").write_text("\n".join(lines) + "\n")


def test_the_same_motion_in_another_frame_is_no_displacement(study):
    folder = study({"a": {"c1": {}}, "b": {"c1": {}}})
    moved(folder / "b" / "c1", 0.7, 300.0)
    read = load_study(folder)
    (error,) = displacements_from(read, "a")["B"]
    assert error.average_m == pytest.approx(0.0, abs=1e-3)


def test_a_slower_approach_is_displaced_by_what_it_lacks(study):
    folder = study({"a": {"c1": {}}, "b": {"c1": {}}})
    moved(folder / "b" / "c1", 0.0, 0.0, faster=0.5)
    read = load_study(folder)
    error = displacement_between(read.ran["a"]["c1"], read.ran["b"]["c1"])
    # V1 covers 16 m in the 1.6 s before contact, then 8 m; V2 stands: half of it on average of the two
    assert error.final_m == pytest.approx(4.0, abs=1e-3)
    assert error.average_m == pytest.approx(2.0, abs=1e-3)


def test_a_run_that_never_touched_is_not_held_against_another(study):
    folder = study({"a": {"c1": {}}, "b": {"c1": {"status": "refused"}}})
    read = load_study(folder)
    assert displacements_from(read, "a") == {}
    assert displacements_from(read, None) == {}

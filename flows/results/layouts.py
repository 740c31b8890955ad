"""The tables: layouts of the publication with arms as rows, each with its reading in the header."""

from __future__ import annotations

from typing import NamedTuple

from flows.results import measures as m


class Layout(NamedTuple):
    """A table before it has figures. `by_level`: only arms with a robustness level, in the order of levels."""

    key: str
    title: str
    note: str
    measures: tuple[m.Measure, ...]
    by_level: bool = False


LAYOUTS = (
    Layout(
        "generation", "Generation", "Share of all finished cases in percent. GSR: status `generated`. AER: faulty over "
        "written files after refinement. Attempts: mean a case, both stages. Crash as declared: of the generated cases "
        "that declare a contact, those whose first contact it is.", m.GENERATION,
    ),
    Layout(
        "network_wrong", "Road network: reports with any error", "Reading: share of reports whose count differs from "
        "the truth at all, percent; a case without output counts as wrong. Published values are nearly all whole k/109 "
        "and stand here.", m.NETWORK_WRONG,
    ),
    Layout(
        "network_mean", "Road network: mean error", "Reading: mean of the published formulas over reports, percent; a "
        "case without output counts as 100. No published value is known in this reading.", m.NETWORK_MEAN,
    ),
    Layout(
        "people", "Against people", "Of the cases in which people gave facts (facts.yaml): facts a case, and the share "
        "of them, percent, for which the reader and the writers of the arm had another value (docs/mending.md). People "
        "mend what is wrong, so this is no error rate of all facts.", m.PEOPLE,
    ),
    Layout(
        "truth", "Against the truth: roads of coded reports, motion, first contact", "Share right in percent, of the "
        "reports whose label states the field; a case without output counts as wrong.", m.TRUTH,
    ),
    Layout(
        "criticality_paper", "Criticality, `paper` reading", "Formulas to the letter, from the first vehicle to the "
        "others; generated cases. `P_c > 0` and near miss are shares of scenarios with any such instant (published "
        "values are k/109 and stand there); mean P_c is the formula, a share of instants. ADE and FDE are those of a "
        "constant-velocity prediction.", m.PAPER,
    ),
    Layout(
        "risk_paper", "Risk distribution, `paper` reading", "Share of generated scenarios by level of S_e, percent.",
        m.PAPER_RISK,
    ),
    Layout(
        "criticality_exact", "Criticality, `exact` reading", "Oriented boxes, every pair of which one moves; generated "
        "cases; TTC and PET of the cases that have one. Not comparable with published values.", m.EXACT,
    ),
    Layout(
        "conflict", "Conflict figures of the scripted crashes", "Of generated cases with contact, in a script "
        "without reaction. TTC-1s, DRAC-1s: 1 s before contact; exposed: time with TTC < 1.5 s; delta-v: the larger "
        "of both; death: risk; brake by, steer by: the last moment at which it still avoids, of the actor that had to "
        "act first. Drives by drivers stand in the tables of `sgcad drive`.",
        m.CONFLICT,
    ),
    Layout(
        "driven", "Handed over to a driver", "Arms whose config has one driver in its stage `drive`; shares of driven "
        "cases, percent, initiators and responders apart (docs/drivers.md). Mitigated: delta-v 10 % and 0.5 m/s under "
        "the script's; lost: the ego never came into the conflict, no credit. Scripted figures stand elsewhere.",
        m.DRIVEN,
    ),
    Layout(
        "robustness", "Robustness levels", "Network errors as share of generated reports with any error, percent (a "
        "refused case is no network error here).", m.ROBUSTNESS, True,
    ),
)  # fmt: skip

"""Made reports in the form that readers give. Apart from the rest, since mini's drawings load torch."""

from __future__ import annotations

import io

from research.generator.report import Report
from research.rows.row_stream import drawing
from sgcad_core.case.records import CrashReport, Diagram


def as_report(report: Report) -> CrashReport:
    """A made report as readers give one, with its drawing if it has one."""
    picture = drawing(report)
    diagrams: tuple[Diagram, ...] = ()
    if picture is not None:
        out = io.BytesIO()
        picture.save(out, "PNG")
        diagrams = (Diagram(png=out.getvalue(), width_px=picture.width, height_px=picture.height),)
    return CrashReport(case=f"made-{report.seed}", narrative=report.narrative, diagrams=diagrams)

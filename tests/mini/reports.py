"""What tests of made reports read them by."""

from collections.abc import Iterator

from mini.generator.report import Report


def sentences(report: Report) -> Iterator[tuple[str, frozenset[str]]]:
    """The sentences of a narrative, without the blanks around them, and the facts that each tells."""
    begun = 0
    for end, facts in report.sentences:
        yield report.narrative[begun:end].strip(), facts
        begun = end

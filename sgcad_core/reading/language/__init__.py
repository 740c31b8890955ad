"""Wordings as data: vocabulary, rules that refer to it, their examples. Knows no report, draws no conclusion.

`words("compass")`, `values("compass")` give a word class, `rule("lanes.each")` the rule of that id, `of_role("deed")`
the rules of a role in their order. Data files: `vocabulary/*.yaml` and `rules/*.yaml`; see docs/language.md.
"""

from sgcad_core.reading.language.data import values, words
from sgcad_core.reading.language.rules import Rule, of_role, rule

__all__ = ["Rule", "of_role", "rule", "values", "words"]

"""The account of a case: stated things that the scenario has, those that it lacks, and assumptions.

Layer: above records, roads, metrics and execution; result.json is made with it. Knows no file and no plugin.
"""

from sgcad_core.account.assumed import is_unsure
from sgcad_core.account.build import account_of
from sgcad_core.account.notes import Note
from sgcad_core.account.records import Account, Disagreement, Item

__all__ = ["Account", "Disagreement", "Item", "Note", "account_of", "is_unsure"]

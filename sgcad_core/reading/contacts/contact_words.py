"""The words around a verb of hitting: voice, near misses, objects, where, with what, by whom. Patterns only."""

from __future__ import annotations

from sgcad_core.reading.language import rule

PASSIVE = rule("contact_words.passive")
NEAR_MISS = rule("contact_words.near_miss")
TO_HIT = rule("contact_words.to_hit")
ACTIVE_OBJECT = rule("contact_words.active_object")
WITH_ITS = rule("contact_words.with_its")
ON_THE = rule("contact_words.on_the")
BY = rule("contact_words.by")
THE_AREA = rule("contact_words.the_area")
PRONOUN_OBJECT = rule("contact_words.pronoun_object")
OBJECT = rule("contact_words.object")
ANY_OBJECT = rule("contact_words.any_object")
PERSON_WAS = rule("contact_words.person_was")
THING_MOVES = rule("contact_words.thing_moves")
THING_WAS = rule("contact_words.thing_was")
DAMAGED = rule("contact_words.damaged")
CAUSED = rule("contact_words.caused")
ASIDE = rule("contact_words.aside")
CLAUSE_END = rule("contact_words.clause_end")
BETWEEN = rule("contact_words.between")
BOTH_PARTS = rule("contact_words.both_parts")
PUSHED = rule("contact_words.pushed")
AGAINST = rule("contact_words.against")
OF_BOTH = rule("contact_words.of_both")
PAIRED = rule("contact_words.paired")

"""Edits of single facts by a person: kept in facts.yaml beside the report, applied to every spec.

`EDITABLE` lists the kinds of fields that can be edited, `fields_of` those of a case. `read_edits` and `write_edits`
keep edits in facts.yaml. `apply_road_edits` and `apply_scenario_edits` change written specs before they are compiled
and planned; `unapplied_edits` lists edits without effect. An edit outranks every reader. Knows no flow and no config.
"""

from __future__ import annotations

from sgcad_core.records.edits import AS_READ as AS_READ
from sgcad_core.records.edits import Edit as Edit
from sgcad_core.records.edits import canonical as canonical
from sgcad_core.records.edits import effective as effective
from sgcad_core.revision.apply import apply_road_edits as apply_road_edits
from sgcad_core.revision.apply import apply_scenario_edits as apply_scenario_edits
from sgcad_core.revision.fields import EDITABLE as EDITABLE
from sgcad_core.revision.fields import CaseField as CaseField
from sgcad_core.revision.fields import Editable as Editable
from sgcad_core.revision.fields import fields_of as fields_of
from sgcad_core.revision.fields import parsed_edit as parsed_edit
from sgcad_core.revision.file import read_edits as read_edits
from sgcad_core.revision.file import report_digest as report_digest
from sgcad_core.revision.file import write_edits as write_edits
from sgcad_core.revision.finding_fields import OverruledValidator as OverruledValidator
from sgcad_core.revision.finding_fields import findings_by_field as findings_by_field
from sgcad_core.revision.finding_fields import overruled_validators as overruled_validators
from sgcad_core.revision.standing_edits import unapplied_edits as unapplied_edits

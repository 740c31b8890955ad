"""What people know better than a reading: edits of single facts, kept beside the report, laid over all specs.

`EDITABLE` says what can be edited, `fields_of` what a case has of it; `read_edits` and `write_edits` keep edits in
`facts.yaml`; `lay_road` and `lay_scenario` lay them over what was written before it is planned; `standing` says which
of them stand in a result. A person wins over every reader. Knows no flow and no config.
"""

from __future__ import annotations

from sgcad_core.records.edits import AS_READ as AS_READ
from sgcad_core.records.edits import Edit as Edit
from sgcad_core.records.edits import canonical as canonical
from sgcad_core.records.edits import effective as effective
from sgcad_core.revision.apply import lay_road as lay_road
from sgcad_core.revision.apply import lay_scenario as lay_scenario
from sgcad_core.revision.fields import EDITABLE as EDITABLE
from sgcad_core.revision.fields import CaseField as CaseField
from sgcad_core.revision.fields import Editable as Editable
from sgcad_core.revision.fields import checked as checked
from sgcad_core.revision.fields import fields_of as fields_of
from sgcad_core.revision.file import read_edits as read_edits
from sgcad_core.revision.file import report_digest as report_digest
from sgcad_core.revision.file import write_edits as write_edits
from sgcad_core.revision.finding_fields import Heeding as Heeding
from sgcad_core.revision.finding_fields import by_field as by_field
from sgcad_core.revision.finding_fields import heeding as heeding
from sgcad_core.revision.standing_edits import standing as standing

"""Headers: source, date, assumptions, whatever the texts hold."""

from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.formats.openscenario.writing.header import Source, file_header, stamped, today
from sgcad_core.formats.xml import parse_xml

PLANNED = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<OpenSCENARIO>\n  <FileHeader description="crash" author="SG-CADVLM" '
    'revMajor="1" revMinor="2" date="2000-01-01T00:00:00+00:00" />\n</OpenSCENARIO>\n'
)


def parsed(xml):
    return parse_xml(xml, "made")


def test_stamp_sets_source_and_date():
    header = parsed(stamped(PLANNED, Source("c-1", "V1 strikes V2", (), "2026-11-27T10:00:00"))).find("FileHeader")
    assert header.get("description") == "c-1: V1 strikes V2"
    assert header.get("date") == "2026-11-27T10:00:00"


@given(case=st.text(max_size=60), about=st.text(max_size=60), line=st.text(max_size=300))
def test_stamped_file_stays_xml_with_any_text(case, about, line):
    told = parsed(stamped(PLANNED, Source(case, about, (line,))))
    assert told.find("FileHeader").get("author") == "SG-CADVLM"


def test_date_can_be_fixed_for_files_that_are_to_be_reproduced(monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert today() == "1970-01-02T00:00:00"


def test_header_has_the_version():
    assert file_header(Source("c"), 3).get("revMinor") == "3"

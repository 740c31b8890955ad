"""Readers understand what NHTSA publishes and refuse what would hurt, naming file, value and remedy."""

import io
import zlib

import pytest
from PIL import Image

from plugins.report_reader.auto import Auto
from plugins.report_reader.folder import Folder
from sgcad_core.errors import BadInput

NARRATIVE = (
    "The crash occurred at the four-leg intersection of two two-lane roads. V1, a 1999 Ford Taurus, was traveling "
    "north. V2, a 2003 Honda Civic, was traveling east. The front of V1 struck the right side of V2."
)
NMVCCS = """<?xml version="1.0" encoding="UTF-8"?><Case CaseID="7"><NMVCCS>
<GeneralVehicle VEHICLEID="11"><VEHICLE><VEHNUMBER>1</VEHNUMBER><MAKE>FORD</MAKE></VEHICLE>
<ROADWAY><NUM_OF_TRAVEL_LANES>Two</NUM_OF_TRAVEL_LANES></ROADWAY></GeneralVehicle>
<GeneralVehicle VEHICLEID="12"><VEHICLE><VEHNUMBER>2</VEHNUMBER></VEHICLE></GeneralVehicle>
<Crash><CRASH><XML_CASESUMMARY><SUMMARY>{text}</SUMMARY></XML_CASESUMMARY></CRASH>
<EVENT><EVENT_NUMBER>1</EVENT_NUMBER><VEHICLE_STRIKER>11</VEHICLE_STRIKER>
<STRIKER_AREA_DAMAGE>Front</STRIKER_AREA_DAMAGE><OBJECT_HIT>Vehicle#2</OBJECT_HIT>
<HIT_AREA_DAMAGE>Right Side</HIT_AREA_DAMAGE></EVENT></Crash>
<PrecrashAssessmentForm VEHICLEID="11"><PRECRASH><PRE_EVENT_MOVEMENT>Going straight</PRE_EVENT_MOVEMENT></PRECRASH>
</PrecrashAssessmentForm></NMVCCS></Case>"""
CIREN = """<?xml version="1.0"?><Case CaseID="8"><CaseForm><CaseSummary><Summary>{text}</Summary></CaseSummary>
<Events><EventSum VehicleNumber="1" EventNumber="1"><AreaOfDamage>Front</AreaOfDamage><Contacted>Vehicle#2</Contacted>
<ContactedAreaOfDamage>Right</ContactedAreaOfDamage></EventSum></Events></CaseForm>
<GeneralVehicleForms><GeneralVehicleForm VehicleNumber="1"><Precrash><Roadway><TravelLanes>Three</TravelLanes></Roadway>
</Precrash></GeneralVehicleForm></GeneralVehicleForms></Case>"""


def png(width=40, height=30, mode="RGB", **options) -> bytes:
    out = io.BytesIO()
    Image.new(mode, (width, height)).save(out, options.pop("format", "PNG"), **options)
    return out.getvalue()


def folder(path, **files):
    path.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        (path / name.replace("__", ".")).write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize("name", ["report__txt", "narrative__txt", "Report__TXT"])
def test_a_folder_gives_narrative_and_diagram(tmp_path, name):
    report = Auto().read(folder(tmp_path / "case-1", **{name: NARRATIVE, "diagram__png": png()}))
    assert report.case == "case-1"
    assert report.narrative == NARRATIVE
    assert [(d.width_px, d.height_px) for d in report.diagrams] == [(40, 30)]


@pytest.mark.parametrize("form", ["JPEG", "GIF", "BMP", "TIFF", "WEBP"])
def test_every_common_picture_format_becomes_rgb_png(tmp_path, form):
    report = Auto().read(folder(tmp_path / "c", report__txt=NARRATIVE, scene__jpg=png(format=form)))
    picture = Image.open(io.BytesIO(report.diagrams[0].png))
    assert (picture.format, picture.mode) == ("PNG", "RGB")


def test_transparent_diagrams_stand_on_white_paper(tmp_path):
    report = Auto().read(folder(tmp_path / "c", report__txt=NARRATIVE, diagram__png=png(mode="RGBA")))
    assert Image.open(io.BytesIO(report.diagrams[0].png)).getpixel((0, 0)) == (255, 255, 255)


@pytest.mark.parametrize(
    "raw",
    [
        NARRATIVE.encode("utf-8-sig"),
        NARRATIVE.encode("utf-16"),
        NARRATIVE.replace(". ", ".\r\n").encode(),
        NARRATIVE.replace(". ", ".\r").encode(),
    ],
    ids=["bom", "utf-16", "crlf", "cr"],
)
def test_encodings_and_line_ends_make_no_difference(tmp_path, raw):
    file = tmp_path / "r.txt"
    file.write_bytes(raw)
    assert Auto().read(file).narrative.split() == NARRATIVE.split()


def test_latin_1_bytes_are_understood(tmp_path):
    file = tmp_path / "r.txt"
    file.write_bytes((NARRATIVE + " The driver of V1 missed the caf\xe9 driveway.").encode("latin-1"))
    assert "café driveway" in Auto().read(file).narrative


@pytest.mark.parametrize("template", [NMVCCS, CIREN])
def test_case_xml_gives_the_narrative_and_keeps_codes_out(tmp_path, template):
    file = tmp_path / "case.xml"
    file.write_text(template.format(text=NARRATIVE).replace("\n", "\r"))
    report = Auto().read(file)
    assert report.narrative == NARRATIVE
    assert report.coded is None


@pytest.mark.parametrize(("template", "line"), [(NMVCCS, "vehicle 1 lanes: Two"), (CIREN, "vehicle 1 lanes: Three")])
def test_coded_fields_are_read_only_when_asked(tmp_path, template, line):
    case = folder(tmp_path / "c", report__txt=NARRATIVE, case__xml=template.format(text="Other words stand here."))
    assert Auto().read(case).narrative == NARRATIVE
    coded = Auto(use_coded_fields=True).read(case).narrative
    assert coded.startswith(NARRATIVE)
    assert line in coded
    assert "event 1 other: V2" in coded


def test_latin_1_bytes_under_a_utf_8_header_are_read(tmp_path):
    file = tmp_path / "case.xml"
    file.write_bytes(NMVCCS.format(text=NARRATIVE + " Caf\xe9.").encode("latin-1"))
    assert "Café" in Auto().read(file).narrative


def test_persons_do_not_reach_the_narrative(tmp_path):
    case = folder(tmp_path / "c", report__txt=NARRATIVE + " The 44-year-old male driver was injured.")
    assert Auto().read(case).narrative == NARRATIVE


def test_switches_narrow_the_evidence(tmp_path):
    case = folder(tmp_path / "c", report__txt=NARRATIVE, diagram__png=png())
    assert Auto(use_diagrams=False).read(case).diagrams == ()
    assert Auto(use_narrative=False).read(case).narrative == ""
    with pytest.raises(BadInput, match="set use_narrative to true"):
        Auto(use_narrative=False, use_diagrams=False).read(case)


def bomb() -> bytes:
    """A 30,000 x 30,000 PNG header over almost no data."""
    header = b"IHDR" + (30000).to_bytes(4, "big") * 2 + b"\x08\x02\x00\x00\x00"
    data = b"IDAT" + zlib.compress(b"\x00" * 10)
    chunks = [header, data, b"IEND"]
    body = b"".join((len(c) - 4).to_bytes(4, "big") + c + zlib.crc32(c).to_bytes(4, "big") for c in chunks)
    return b"\x89PNG\r\n\x1a\n" + body


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b"not a picture", r"diagram.png: no picture of a kind that is read: give PNG"),
        (png()[:60], r"diagram.png: no readable picture"),
        (bomb(), r"diagram.png: .*900000000 pixels.*the limit is 40,000,000 pixels: scale it down"),
        (b"", r"diagram.png: no picture of a kind that is read"),
    ],
    ids=["no picture", "truncated", "bomb", "empty"],
)
def test_a_diagram_that_is_none_is_named(tmp_path, raw, message):
    with pytest.raises(BadInput, match=message):
        Auto().read(folder(tmp_path / "c", report__txt=NARRATIVE, diagram__png=raw))


GERMAN = "Der Unfall ereignete sich auf einer Kreuzung mit vier Armen, als das erste Fahrzeug nach links abbog und " * 3


@pytest.mark.parametrize(
    ("raw", "message"),
    [
        (b"", "has 0 words, at least 3"),
        (b"   \n", "has 0 words, at least 3"),
        (bytes(range(256)) * 9, "binary data"),
        (b"The crash " * 1_100_000, "11,000,000 bytes of text; a narrative has at most 100,000 characters"),
        (GERMAN.encode(), "does not read like English"),
    ],
    ids=["empty", "blank", "binary", "huge", "german"],
)
def test_a_text_that_is_none_is_named(tmp_path, raw, message):
    file = tmp_path / "r.txt"
    file.write_bytes(raw)
    with pytest.raises(BadInput, match=message):
        Auto().read(file)


LAUGHS = '<!DOCTYPE a [<!ENTITY b "ha"><!ENTITY c "&b;&b;&b;">]><Case><NMVCCS>&c;</NMVCCS></Case>'
OUTSIDE = '<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><Case><NMVCCS>&x;</NMVCCS></Case>'


@pytest.mark.parametrize(
    ("xml", "message"),
    [
        (LAUGHS, "has a DOCTYPE"),
        (OUTSIDE, "has a DOCTYPE"),
        ("<Case><NMVCCS>", "broken XML"),
        ("<osm/>", "root <osm> is neither an NMVCCS nor a CIREN case"),
        (NMVCCS.format(text=""), "has no narrative"),
    ],
)
def test_hostile_and_foreign_xml_is_named(tmp_path, xml, message):
    file = tmp_path / "case.xml"
    file.write_text(xml)
    with pytest.raises(BadInput, match=message):
        Auto().read(file)


def test_what_cannot_be_read_is_named(tmp_path):
    with pytest.raises(BadInput, match="no such file or folder"):
        Auto().read(tmp_path / "none.txt")
    (tmp_path / "a.docx").write_bytes(b"x")
    with pytest.raises(BadInput, match=r"suffix '.docx' is not read; give a folder or .txt"):
        Auto().read(tmp_path / "a.docx")
    with pytest.raises(BadInput, match=r"no report.txt or narrative.txt .* found diagram.png"):
        Folder().read(folder(tmp_path / "d", diagram__png=png()))


def test_a_case_id_is_always_a_plain_folder_name(tmp_path):
    file = tmp_path / "a b;c.txt"
    file.write_text(NARRATIVE)
    assert Auto().read(file).case == "a_b_c"


def test_a_pdf_without_text_asks_for_text_recognition(tmp_path):
    from pypdf import PdfWriter

    writer = PdfWriter()
    writer.add_blank_page(200, 200)
    writer.write(tmp_path / "scan.pdf")
    with pytest.raises(BadInput, match="no text layer: run text recognition"):
        Auto().read(tmp_path / "scan.pdf")
    (tmp_path / "b.pdf").write_bytes(b"%PDF-1.7 nonsense")
    with pytest.raises(BadInput, match=r"b.pdf: no readable PDF"):
        Auto().read(tmp_path / "b.pdf")


def test_a_pdf_with_text_and_a_picture_gives_both(tmp_path):
    import matplotlib

    matplotlib.use("Agg")
    import numpy as np
    from matplotlib import pyplot

    figure = pyplot.figure()
    figure.figimage(np.random.default_rng(1).random((300, 400, 3)))
    for i, line in enumerate(NARRATIVE.split(". ")):
        figure.text(0.05, 0.95 - 0.06 * i, line + ".", fontsize=6)
    figure.savefig(tmp_path / "r.pdf")
    pyplot.close(figure)
    report = Auto().read(tmp_path / "r.pdf")
    assert "The front of V1 struck the right side of V2" in " ".join(report.narrative.split())
    assert (report.diagrams[0].width_px, report.diagrams[0].height_px) == (400, 300)

"""What a stranger sends costs its own case: links, pipes, bombs and pictures of every kind."""

import contextlib
import io
import os
import time
import zlib

import numpy as np
import pypdf
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from plugins.report_reader._pdf_pages import MAX_DRAWN, _long_palette
from plugins.report_reader.auto import Auto
from plugins.report_reader.evidence import MAX_NARRATIVE, diagram
from sgcad_core.errors import BadInput
from sgcad_core.system.report_files import read_regular
from tests.plugins.report_reader.test_readers import NARRATIVE, folder, png


def pdf(
    content: bytes, pages: int = 1, more: str = "", *, coding: str = "/FlateDecode", picture: str = "", high: int = 300
) -> bytes:
    """A PDF whose pages all draw the same stream, compressed, and have a picture of a coding."""
    packed = zlib.compress(content)
    kids = " ".join(f"{10 + i} 0 R" for i in range(pages))
    objects = {
        1: "<< /Type /Catalog /Pages 2 0 R >>",
        2: f"<< /Type /Pages /Count {pages} /Kids [{kids}] >>",
        3: "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>",
        4: f"<< /Length {len(packed)} /Filter {coding} {more} >>\nstream\n{packed.decode('latin-1')}\nendstream",
        **{
            10 + i: "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 612 792] /Contents 4 0 R "
            f"/Resources << /Font << /F1 3 0 R >> {'/XObject << /Im0 5 0 R >>' if picture else ''} >> >>"
            for i in range(pages)
        },
    }
    if picture:
        about = f"/Type /XObject /Subtype /Image /Width 300 /Height {high} /BitsPerComponent 1 /ColorSpace /DeviceGray"
        coded = f"/Filter /{picture} /DecodeParms << /JBIG2Globals 4 0 R >> /Length 4"
        objects[5] = f"<< {about} {coded} >>\nstream\n\x97JB2\nendstream"
    out, places = b"%PDF-1.4\n", {}
    for number, text in objects.items():
        places[number] = len(out)
        out += f"{number} 0 obj\n{text}\nendobj\n".encode("latin-1")
    start, most = len(out), max(objects) + 1
    table = "".join(f"{places.get(n, 0):010d} 00000 {'n' if n in places else 'f'} \n" for n in range(most))
    return out + f"xref\n0 {most}\n{table}trailer\n<< /Size {most} /Root 1 0 R >>\nstartxref\n{start}\n%%EOF".encode()


def _read(tmp_path, name, content):
    file = tmp_path / name
    file.write_bytes(content)
    return Auto().read(file)


def test_a_pdf_of_a_narrative_is_read(tmp_path):
    lines = "".join(f"0 -14 Td ({line}.) Tj " for line in NARRATIVE.split(". "))
    assert (
        "struck the right side"
        in _read(tmp_path, "r.pdf", pdf(f"BT /F1 12 Tf 72 720 Td {lines} ET".encode())).narrative
    )


@pytest.mark.parametrize(
    ("content", "pages", "match"),
    [
        (b" " * 4_000_000, 60, r"hold more than 8,000,000 bytes of drawing"),
        (b" " * 4_000_000, 1, r"bytes of drawing, or blanks"),
        (b"q Q " * (MAX_DRAWN // 2 + 1), 1, r"draws more than 100,000 things"),
        (b"BT /F1 12 Tf " + b"(" + b"word " * 30_000 + b") Tj ET", 2, r"more than 100,000 characters"),
    ],
    ids=["shared stream", "blanks", "many operators", "much text"],
)
def test_a_pdf_that_draws_without_end_is_told_in_seconds(tmp_path, content, pages, match):
    started = time.process_time()
    with pytest.raises(BadInput, match=rf"r\.pdf: .*{match}"):
        _read(tmp_path, "r.pdf", pdf(content, pages))
    assert time.process_time() - started < 30


FILTERS = (
    "JBIG2Decode", "JPXDecode", "CCITTFaxDecode", "DCTDecode", "Crypt", "LZWDecode", "RunLengthDecode", "Foo", "42"
)  # fmt: skip


@pytest.fixture
def jbig2dec(tmp_path):
    """A program for JBIG2 that pypdf knows, and that notes that it was started."""
    program = tmp_path / "bin" / "jbig2dec"
    program.parent.mkdir()
    program.write_text(f"#!/bin/sh\ntouch {tmp_path}/started\n")
    program.chmod(0o755)
    with pypdf.apply_configuration(jbig2dec_binary=str(program)):
        yield tmp_path / "started"


@pytest.mark.parametrize("name", FILTERS)
def test_a_picture_in_any_coding_costs_the_picture_alone_and_starts_no_program(tmp_path, jbig2dec, name):
    text = "BT /F1 12 Tf 72 720 Td (The front of V1 struck the rear of V2 there.) Tj ET"
    assert "struck the rear" in _read(tmp_path, "r.pdf", pdf(text.encode(), picture=name)).narrative
    assert not jbig2dec.exists()


@pytest.mark.parametrize("name", FILTERS)
def test_a_picture_that_says_it_is_huge_costs_the_picture_alone(tmp_path, name):
    text = "BT /F1 12 Tf 72 720 Td (The front of V1 struck the rear of V2 there.) Tj ET"
    read = _read(tmp_path, "r.pdf", pdf(text.encode(), picture=name, high=1_000_000))
    assert "struck the rear" in read.narrative
    assert not read.diagrams


@pytest.mark.parametrize(("spaces", "long"), [(0, False), (100_000, True)])
def test_a_palette_beyond_any_real_one_is_not_looked_through(spaces, long):
    made = pdf(b"q Q" + b" " * spaces, picture="FlateDecode")
    made = made.replace(b"/ColorSpace /DeviceGray", b"/ColorSpace [/Indexed /DeviceRGB 255 4 0 R]")
    (page,) = pypdf.PdfReader(io.BytesIO(made)).pages
    assert _long_palette(page, "/Im0") is long


@pytest.mark.parametrize("name", FILTERS)
def test_a_text_in_any_coding_is_read_or_refused(tmp_path, jbig2dec, name):
    with contextlib.suppress(BadInput):
        _read(tmp_path, "r.pdf", pdf(b"BT (The front of V1 struck V2) Tj ET", coding=f"/{name}"))
    assert not jbig2dec.exists()


def test_a_stream_that_is_damaged_once_unpacked_is_given_up_in_seconds(tmp_path):
    started = time.process_time()
    with pytest.raises(BadInput, match="text layer cannot be read"):
        _read(tmp_path, "r.pdf", pdf(b" " * 20_000_000, coding="[/FlateDecode /FlateDecode]"))
    assert time.process_time() - started < 2


@settings(deadline=None)  # a busy machine takes seconds for the first
@given(st.binary(max_size=400), st.integers(0, 600), st.integers(0, 40))
def test_a_damaged_pdf_is_read_or_refused(tmp_path_factory, noise, at, cut):
    whole = pdf(b"BT /F1 12 Tf 72 720 Td (The front of V1 struck the rear of V2 there.) Tj ET")
    damaged = whole[:at] + noise + whole[at + cut :]
    with contextlib.suppress(BadInput):
        assert _read(tmp_path_factory.getbasetemp(), "damaged.pdf", damaged).narrative


@pytest.mark.parametrize("name", ["r.txt", "r.xml"])
def test_a_narrative_has_a_limit_in_every_format(tmp_path, name):
    text = "the front of V1 struck V2 " * (MAX_NARRATIVE // 20)
    wrapped = f"<Case><CaseForm><CaseSummary><Summary>{text}</Summary></CaseSummary></CaseForm></Case>"
    with pytest.raises(BadInput, match="at most 100,000"):
        _read(tmp_path, name, (wrapped if name.endswith("xml") else text).encode())


# ------------------------------------------------------------------ files that are none
def test_a_link_out_of_the_folder_is_not_followed(tmp_path):
    secret = tmp_path / "secret.txt"
    secret.write_text(NARRATIVE)
    case = folder(tmp_path / "case")
    (case / "report.txt").symlink_to(secret)
    with pytest.raises(BadInput, match=r"report\.txt: leads out of its folder: put the file itself"):
        Auto().read(case)
    bare = folder(tmp_path / "inbox") / "r.txt"
    bare.symlink_to(secret)
    with pytest.raises(BadInput, match="leads out of its folder"):
        Auto().read(bare)


def test_a_diagram_linked_from_elsewhere_is_not_shown(tmp_path):
    picture = tmp_path / "private.png"
    picture.write_bytes(png())
    case = folder(tmp_path / "case", report__txt=NARRATIVE)
    (case / "diagram.png").symlink_to(picture)
    with pytest.raises(BadInput, match=r"diagram\.png: leads out"):
        Auto().read(case)


def test_a_link_inside_the_folder_is_a_file(tmp_path):
    case = folder(tmp_path / "case", text__md=NARRATIVE)
    (case / "report.txt").symlink_to("text.md")
    assert Auto().read(case).narrative == NARRATIVE


@pytest.mark.parametrize("name", ["report.txt", "diagram.png", "case.xml"])
def test_a_pipe_in_a_folder_is_no_file(tmp_path, name):
    case = folder(tmp_path / "case")
    os.mkfifo(case / name)
    with pytest.raises(BadInput, match="no single XML, PDF or text file; found nothing"):
        Auto().read(case)


@pytest.mark.parametrize("place", ["/dev/zero", "/proc/self/environ", "pipe", "itself"])
def test_a_device_a_pipe_and_a_circle_end_at_once(tmp_path, place):
    file = tmp_path / "r.txt"
    if place == "pipe":
        os.mkfifo(file)
    else:
        file.symlink_to(file if place == "itself" else place)
    with pytest.raises(BadInput, match=r"leads out of its folder|not a regular file"):
        Auto().read(file)


def test_a_file_that_grows_while_it_is_read_is_cut_off(tmp_path):
    file = tmp_path / "f"
    file.write_bytes(b"x" * 100)
    assert read_regular(file, most=100) == b"x" * 100
    with pytest.raises(BadInput, match="100 bytes, the limit is 99"):
        read_regular(file, most=99)


# ------------------------------------------------------------------ pictures
def _pixel(raw):
    return Image.open(io.BytesIO(diagram(raw, None).png)).getpixel((0, 0))


def test_sixteen_bits_a_pixel_keep_their_greys():
    out = io.BytesIO()
    Image.fromarray(np.full((4, 4), 0x8000, np.uint16)).save(out, "PNG")
    assert _pixel(out.getvalue()) == (128, 128, 128)


def test_a_photo_taken_sideways_is_turned_upright():
    picture, out = Image.new("RGB", (40, 20), "red"), io.BytesIO()
    exif = picture.getexif()
    exif[0x0112] = 6
    picture.save(out, "JPEG", exif=exif)
    shown = diagram(out.getvalue(), None)
    assert (shown.width_px, shown.height_px) == (20, 40)


@settings(deadline=None)
@given(st.sampled_from(["PNG", "JPEG", "GIF", "BMP", "TIFF", "WEBP"]), st.integers(0, 2000), st.binary(max_size=60))
def test_a_damaged_picture_is_read_or_refused(form, at, noise):
    raw = png(format=form)
    with contextlib.suppress(BadInput):
        assert diagram(raw[: at % len(raw)] + noise + raw[at % len(raw) + len(noise) :], "p").png

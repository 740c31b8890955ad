"""PDFs: pages of text changed, and objects, codings, trees and pictures that no printer makes."""

from __future__ import annotations

import random
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

from research.benchmarks.fuzz import making

NAME = "pdf"
CODINGS = (
    "JBIG2Decode", "JPXDecode", "CCITTFaxDecode", "DCTDecode", "Crypt", "LZWDecode", "RunLengthDecode",
    "ASCIIHexDecode",
    "ASCII85Decode", "FlateDecode", "Foo", "[/FlateDecode /FlateDecode]", "[" + "/ASCIIHexDecode " * 500 + "]",
)  # fmt: skip
TEXT = b"BT /F1 9 Tf 40 700 Td (The front of Vehicle 1 struck the back of Vehicle 2 on the two lane road.) Tj ET"
FONT = "<</Type/Font/Subtype/Type1/BaseFont/Helvetica>>"
CATALOG = "<</Type/Catalog/Pages 2 0 R>>"


def inputs(rng: random.Random, folder: Path) -> Iterator[Path]:
    """PDF files."""
    for number in range(10**9):
        file = folder / f"report-{number}.pdf"
        file.write_bytes(making.pdf(rng) if rng.random() < 0.4 else _changed(rng, _evil(rng)))
        yield file


def written(objects: dict[int, bytes], trailer: str = "/Root 1 0 R") -> bytes:
    """A PDF of numbered objects."""
    out, places = b"%PDF-1.7\n", {}
    for number, content in objects.items():
        places[number] = len(out)
        out += f"{number} 0 obj ".encode() + content + b" endobj\n"
    most = max(objects) + 1
    rows = "".join(f"{places.get(n, 0):010d} 00000 {'n' if n in places else 'f'} \n" for n in range(most))
    return out + f"xref\n0 {most}\n{rows}trailer <</Size {most}{trailer}>>\nstartxref\n{len(out)}\n%%EOF\n".encode()


def stream(data: bytes, about: str = "") -> bytes:
    """A stream object."""
    return f"<</Length {len(data)}{about}>> stream\n".encode() + data + b"\nendstream"


def page(content: bytes = TEXT, about: str = "", more: dict[int, bytes] | None = None, extra: str = "") -> bytes:
    """One page that draws a stream, with further objects."""
    kid = f"<</Type/Page/Parent 2 0 R/MediaBox[0 0 612 792]/Contents 4 0 R/Resources<</Font<</F1 5 0 R>>{extra}>>>>"
    objects = {1: CATALOG, 2: "<</Type/Pages/Kids[3 0 R]/Count 1>>", 3: kid, 5: FONT}
    return written({n: o.encode() for n, o in objects.items()} | {4: stream(content, about)} | (more or {}))


def _picture(rng: random.Random) -> bytes:
    side = rng.choice((1, 300, 9000, 10**6, -5))
    space = rng.choice(("/DeviceGray", "/DeviceCMYK", "[/Indexed /DeviceRGB 255 6 0 R]", "/Nope", "[/ICCBased 6 0 R]"))
    about = f"/Type/XObject/Subtype/Image/Width {side}/Height {side}/BitsPerComponent {rng.choice((1, 8, 16, 3, 0))}"
    parameters = rng.choice(
        ("", "/DecodeParms<</JBIG2Globals 6 0 R>>", "/DecodeParms<</Predictor 15/Columns 99999999>>")
    )
    name = rng.choice(CODINGS)
    coding = f"/Filter {name if name.startswith('[') else f'/{name}'}{parameters}/ColorSpace {space}"
    data = rng.choice((rng.randbytes(50), zlib.compress(bytes(rng.choice((100, 90_000, 30_000_000))))))
    return page(more={6: stream(data, about + coding)}, extra="/XObject<</I 6 0 R>>")


def _text(rng: random.Random) -> bytes:
    name = rng.choice(CODINGS)
    coding = f"/Filter {name if name.startswith('[') else f'/{name}'}"
    return page(rng.choice((TEXT, zlib.compress(TEXT), zlib.compress(b" " * 20_000_000))), coding)


def _tree(rng: random.Random) -> bytes:
    """Trees of pages that end in themselves, are deep, or broad."""
    deep = rng.choice((5, 900, 3000))
    kids = {n: f"<</Type/Pages/Kids[{n + 1} 0 R]/Count 1/Parent {n - 1} 0 R>>".encode() for n in range(2, deep)}
    itself = {2: f"<</Type/Pages/Kids[{'2 0 R ' * rng.choice((1, 40))}]/Count 1>>".encode()}
    broad = {2: f"<</Type/Pages/Kids[{'3 0 R ' * rng.choice((70, 5000))}]/Count 70>>".encode(), 3: b"<</Type/Page>>"}
    return written({1: CATALOG.encode()} | rng.choice((kids, itself, broad)))


def _fonts(rng: random.Random) -> bytes:
    ranges = b"".join(b"<%04x> <ffff> <0041>\n" % (n % 65536) for n in range(rng.choice((3, 100, 2000))))
    unicode_map = b"/CIDInit /ProcSet findresource begin begincmap 1 beginbfrange\n" + ranges + b"endbfrange endcmap"
    kind = rng.choice(("Type0", "Type3", "TrueType", "Nope"))
    encoding = rng.choice(("/Identity-H", "7 0 R", "/Nope", "[1 2]"))
    font = f"<</Type/Font/Subtype/{kind}/Encoding {encoding}/ToUnicode 6 0 R>>"
    return page(more={5: font.encode(), 6: stream(unicode_map), 7: b"<</Differences[0 /a 300 /b (c)]>>"})


def _evil(rng: random.Random) -> bytes:
    deep = rng.choice((50, 2000, 100_000))
    ways: tuple[Callable[[], bytes], ...] = (
        lambda: _picture(rng),
        lambda: _text(rng),
        lambda: _tree(rng),
        lambda: _fonts(rng),
        lambda: page(b"q " * rng.choice((100, 40_000)) + TEXT),
        lambda: page(b"[" * deep + TEXT),
        lambda: page(b"<<" * deep + TEXT),
        lambda: page(b"BT " + b"(" * deep + b") Tj ET"),
        lambda: page(TEXT + b" BI /W 9999999 /H 9999999 ID " + rng.randbytes(200) + b" EI"),
        lambda: page(more={6: b"[" * deep + b"]" * deep}, extra="/XObject 6 0 R"),
        lambda: page(more={6: stream(b"/F Do", "/Type/XObject/Subtype/Form/Resources<</XObject<</F 6 0 R>>>>")},
                     extra="/XObject<</F 6 0 R>>"),
        lambda: page().replace(b"/Root 1 0 R", b"/Root 1 0 R/Encrypt<</Filter/Standard/V 5/R 6/Length 256>>"),
        lambda: page().replace(b"/Root 1 0 R", b"/Root 1 0 R/Prev 9"),
        lambda: page().replace(b"/Contents 4 0 R", b"/Contents [" + b"4 0 R " * rng.choice((2, 3000)) + b"]"),
        lambda: page().replace(b"612 792", rng.choice((b"0 0", b"1e99 x", b"(a) /b", b"-1 -1"))),
        lambda: page().replace(b"/Length ", b"/Length 9999999999 /Was "),
        lambda: b"%PDF-1.7\n" + rng.randbytes(rng.randrange(5000)),
        lambda: b"",
    )  # fmt: skip
    return rng.choice(ways)()


def _changed(rng: random.Random, content: bytes) -> bytes:
    """Up to three numbers or bytes changed."""
    found = bytearray(content)
    for _ in range(rng.choice((0, 0, 1, 2, 3))):
        at = rng.randrange(len(found) + 1)
        found[at : at + rng.choice((0, 1, 1, 20))] = rng.choice(
            (b"0", b"-1", b"99999999999", b"/", b"<<", rng.randbytes(3))
        )
    return bytes(found)


def feed(item: Path) -> None:
    """Give a file to the default reader."""
    from plugins.report_reader.auto import Auto

    Auto().read(item)

"""Pictures beside a report: files of six formats changed, other formats, lying sizes, bombs, odd modes and blocks."""

from __future__ import annotations

import io
import random
import struct
import zlib
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

from PIL import Image

NAME = "picture"
SUFFIXES = ("png", "jpg", "jpeg", "gif", "bmp", "tif", "tiff", "webp", "PNG")
FORMATS = ("PNG", "JPEG", "GIF", "BMP", "TIFF", "WEBP")
OTHERS = ("EPS", "PDF", "ICO", "PPM", "TGA", "PCX", "SGI", "JPEG2000", "DDS", "IM", "MSP", "XBM")
MODES = ("1", "L", "P", "RGB", "RGBA", "CMYK", "I;16", "LA", "I", "F")
TEXT = "The crash occurred on a two-lane road. The front of Vehicle #1 struck the back of Vehicle #2 in daylight.\n"
EPS = (
    b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 300 300\n%%EndComments\n"
    b"(/tmp/owned) (w) file (x) writestring showpage\n%%EOF\n"
)


def inputs(rng: random.Random, folder: Path) -> Iterator[Path]:
    """Case folders with a plain report and an odd picture."""
    for number in range(10**9):
        (case := folder / f"case-{number}").mkdir()
        (case / "report.txt").write_text(TEXT, encoding="utf-8")
        (case / f"diagram.{rng.choice(SUFFIXES)}").write_bytes(picture(rng))
        yield case


def picture(rng: random.Random) -> bytes:
    """One picture: mostly a good one with changed bytes."""
    return _damaged(rng, saved(rng.choice(FORMATS), rng.choice(MODES))) if rng.random() < 0.6 else _evil(rng)


@cache
def saved(kind: str, mode: str) -> bytes:
    """A small picture of a format, in a mode or, where the format has none such, in RGB."""
    drawn = Image.linear_gradient("L").resize((320, 240))
    for image in (drawn.convert("I").convert(mode) if mode == "I;16" else drawn.convert(mode), drawn.convert("RGB")):
        out = io.BytesIO()
        try:
            image.save(out, kind)
        except (OSError, ValueError, KeyError):
            continue
        return out.getvalue()
    return b""


def _damaged(rng: random.Random, content: bytes) -> bytes:
    found = bytearray(content)
    for _ in range(rng.randrange(6)):
        if not found:
            break
        at = rng.randrange(min(len(found), rng.choice((64, 1024, 10**9))))
        way = rng.randrange(5)
        if way == 0:
            found[at] = rng.randrange(256)
        elif way == 1:
            found[at : at + 4] = rng.choice((b"\xff\xff\xff\xff", b"\0\0\0\0", b"\x7f\xff\xff\xff", rng.randbytes(4)))
        elif way == 2:
            del found[at : at + rng.randrange(1, 300)]
        elif way == 3:
            found[at:at] = rng.randbytes(rng.randrange(1, 300))
        else:
            found = found[:at] if rng.random() < 0.3 else found
    return bytes(found)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width: int, height: int, data: bytes, depth: int = 8, color: int = 2, more: bytes = b"") -> bytes:
    """A PNG of any claims."""
    head = struct.pack(">IIBBBBB", width & 0xFFFFFFFF, height & 0xFFFFFFFF, depth, color, 0, 0, 0)
    body = _chunk(b"IHDR", head) + more + _chunk(b"IDAT", data) + _chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def _frames(rng: random.Random) -> bytes:
    out = io.BytesIO()
    width = rng.choice((1, 50, 400))
    frames = [Image.new("P", (width, 50), k % 256) for k in range(rng.choice((2, 50, 400)))]
    frames[0].save(out, rng.choice(("GIF", "WEBP", "TIFF", "PNG")), save_all=True, append_images=frames[1:])
    return out.getvalue()


def _exif(rng: random.Random) -> bytes:
    exif = Image.Exif()
    exif[0x0112] = rng.choice((1, 3, 6, 8, 9, 65535))
    exif[0x010E] = "x" * rng.choice((1, 60_000))
    out = io.BytesIO()
    Image.new("RGB", (300, 200)).save(out, rng.choice(("JPEG", "PNG", "WEBP")), exif=exif.tobytes())
    return _damaged(rng, out.getvalue())


@cache
def _zeros(count: int) -> bytes:
    return zlib.compress(bytes(count))


def _evil(rng: random.Random) -> bytes:
    big = rng.choice((1, 8000, 60_000, 2**31 - 1, 2**32 - 1))
    zeros = _zeros(rng.choice((10, 10_000_000, 50_000_000)))
    ways: tuple[Callable[[], bytes], ...] = (
        lambda: png(big, rng.choice((1, 5000, big)), zeros),
        lambda: png(6000, 6000, _zeros(6000 * 6001), color=0),
        lambda: png(300, 300, zeros, rng.choice((1, 3, 16, 255)), rng.choice((0, 3, 5, 6, 99))),
        lambda: png(300, 300, zeros, more=_chunk(rng.choice((b"zTXt", b"iCCP", b"iTXt")), b"x\0\0" + zeros)),
        lambda: png(300, 300, zeros, more=_chunk(b"tRNS", rng.randbytes(rng.randrange(900)))),
        lambda: rng.choice((EPS, b"\xc5\xd0\xd3\xc6" + EPS, EPS.replace(b"300 300", b"99999 99999"))),
        lambda: saved(rng.choice(OTHERS), "RGB"),
        lambda: b"GIF89a" + struct.pack("<HH", 65535, 65535) + rng.randbytes(300),
        lambda: b"BM" + struct.pack("<IIIIii", 100, 0, 54, 40, rng.choice((-1, 2**31 - 1)), -(2**31)) + bytes(40),
        lambda: b"II*\0" + struct.pack("<I", 8) + struct.pack("<H", 65535) + rng.randbytes(3000),
        lambda: b"II*\0" + struct.pack("<I", 8) + struct.pack("<HHHIII", 1, 256, 4, 1, 9, 8),
        lambda: b"RIFF" + struct.pack("<I", 2**32 - 1) + b"WEBPVP8X" + rng.randbytes(400),
        lambda: b"\xff\xd8" + b"\xff\xe1\xff\xff" * 3000 + rng.randbytes(100),
        lambda: _frames(rng),
        lambda: _exif(rng),
        lambda: rng.randbytes(rng.randrange(3000)),
        lambda: b"%PDF-1.4\n" + rng.randbytes(500),
        lambda: b"<svg xmlns='http://www.w3.org/2000/svg'><image href='file:///etc/passwd'/></svg>",
        lambda: b"",
    )
    return rng.choice(ways)()


def feed(item: Path) -> None:
    """Give a case folder to the default reader."""
    from plugins.report_reader.auto import Auto

    Auto().read(item)

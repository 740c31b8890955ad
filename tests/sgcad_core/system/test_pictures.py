"""Pictures are opened in one place, by a list of formats."""

import ast
import io
from pathlib import Path

import pytest
from PIL import EpsImagePlugin, Image, UnidentifiedImageError

from sgcad_core.system.pictures import FORMATS, opened
from tests.sources import tree

ROOT = Path(__file__).parents[3]
EPS = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 10 10\n%%EndComments\nshowpage\n%%EOF\n"


@pytest.mark.parametrize("kind", FORMATS)
def test_each_format_of_the_list_is_read(kind, tmp_path):
    out = io.BytesIO()
    Image.new("RGB", (6, 4), "red").save(out, kind)
    (tmp_path / "picture").write_bytes(out.getvalue())
    for source in (out.getvalue(), tmp_path / "picture"):
        with opened(source) as picture:
            assert picture.convert("RGB").size == (6, 4)


def test_postscript_reaches_no_ghostscript(monkeypatch):
    monkeypatch.setattr(EpsImagePlugin, "Ghostscript", lambda *_, **__: pytest.fail("Ghostscript was started"))
    with Image.open(io.BytesIO(EPS)) as picture:
        assert picture.format == "EPS"  # Pillow alone would take it
    with pytest.raises(UnidentifiedImageError):
        opened(EPS)


@pytest.mark.parametrize("kind", ["PPM", "TGA", "ICO", "PCX"])
def test_a_picture_of_another_format_is_refused(kind):
    out = io.BytesIO()
    Image.new("RGB", (16, 16)).save(out, kind)
    with pytest.raises(UnidentifiedImageError):
        opened(out.getvalue())


def test_no_other_module_of_the_product_opens_pictures():
    found = [
        str(file.relative_to(ROOT))
        for folder in ("sgcad_core", "plugins", "flows")
        for file in (ROOT / folder).rglob("*.py")
        for node in ast.walk(tree(file))
        if isinstance(node, ast.Attribute) and ast.unparse(node) == "Image.open"
    ]
    assert found == ["sgcad_core/system/pictures.py"]

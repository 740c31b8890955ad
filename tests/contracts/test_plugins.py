"""Promises that every installed plugin keeps, whoever wrote it."""

import importlib
import sys

import pytest
from pydantic import ValidationError

from sgcad_core import entry_points, foreign_plugins, registry
from sgcad_core.errors import ConfigError

INSTALLED = [(kind, name) for kind in entry_points.KINDS for name in entry_points.catalogue(kind)]


@pytest.fixture(params=INSTALLED, ids=lambda p: "-".join(p))
def plugin(request):
    return registry.plugin_class(*request.param)


def test_a_plugin_is_closed_and_frozen(plugin):
    assert plugin.model_config["extra"] == "forbid"
    assert plugin.model_config["frozen"] is True
    with pytest.raises(ValidationError, match="no_such_field"):
        plugin(no_such_field=1)


def test_a_plugin_says_what_it_does(plugin):
    assert plugin.__doc__
    assert "Usage docs" not in plugin.__doc__
    assert isinstance(plugin.version, str)


def test_a_plugin_is_final_or_abstract(plugin):
    assert not plugin.__abstractmethods__
    assert not [c for c in plugin.__subclasses__() if not c.__module__.startswith("tests.")]


def test_the_kinds_are_those_of_the_interfaces():
    assert tuple(registry.BASES) == entry_points.KINDS


def test_an_unknown_plugin_names_the_nearest_and_all():
    with pytest.raises(ConfigError, match=r"unknown decoder 'greedi'. Did you mean 'greedy'\? Installed: .*cad"):
        registry.plugin_class("decoder", "greedi")


STRANGE = """
from sgcad_core.interfaces import Decoder, Validator

class NoStage(Validator):
    def findings(self, artifact, evidence):
        return []

class WrongStage(NoStage):
    stage = "roads"

class NoMethod(Validator):
    stage = "road"

class NoPrior(Decoder):
    def scores(self, with_context, without_context):
        return with_context
"""


@pytest.mark.parametrize(
    ("kind", "attribute", "message"),
    [
        (
            "validator",
            "NoStage",
            r"'stage' is missing or wrong \(found None\): write `stage = \"road\" or \"scenario\"",
        ),
        ("validator", "WrongStage", r"'stage' is missing or wrong \(found 'roads'\)"),
        ("validator", "NoMethod", r"the method 'findings' is missing: write `def findings\(self, ...\)` as Validator"),
        (
            "decoder",
            "NoPrior",
            r"'needs_prior' is missing or wrong \(found None\): write `needs_prior = True or False`",
        ),
        ("decoder", "NoStage", r"is no Decoder: derive it from that class"),
    ],
)
def test_a_strangers_class_without_its_kinds_form_is_told_with_the_line_that_mends_it(
    monkeypatch, tmp_path, kind, attribute, message
):
    (tmp_path / "strange_kit.py").write_text(STRANGE)
    load(monkeypatch, tmp_path, kind, f"strange_kit:{attribute}", message)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("alpha = 0.7", r"is no valid plugin class: the field 'alpha' has no type: write `alpha: float = 0.7`"),
        ("alpha: int = 1 / 0", r"fails while it is imported: ZeroDivisionError: division by zero"),
        ("alpha: = 2", r"fails while it is imported: SyntaxError"),
    ],
)
def test_a_strangers_module_that_fails_is_told_without_a_traceback(monkeypatch, tmp_path, text, message):
    head = "from sgcad_core.interfaces import Decoder\n\nclass Bad(Decoder):\n    needs_prior = True\n    "
    (tmp_path / "strange_bad.py").write_text(head + text + "\n")
    load(monkeypatch, tmp_path, "decoder", "strange_bad:Bad", message)


def load(monkeypatch, folder, kind, value, message):
    """Load what an entry point names and expect this fault."""
    from importlib.metadata import EntryPoint

    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setattr(registry, "catalogue", lambda _: {"odd": EntryPoint("odd", value, f"sgcad.{kind}")})
    registry.plugin_class.cache_clear()
    with pytest.raises(ConfigError, match=message):
        registry.plugin_class(kind, "odd")
    registry.plugin_class.cache_clear()
    sys.modules.pop(value.partition(":")[0], None)


def test_only_entry_points_that_lead_somewhere_are_installed(monkeypatch, tmp_path):
    from importlib.metadata import EntryPoint

    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "half_kit.py").write_text("class There: ...\n")
    points = {name: EntryPoint(name, f"{place}", "sgcad.decoder") for name, place in (
        ("there", "half_kit:There"), ("gone", "half_kit:Gone"), ("nowhere", "no_such_kit:X"),
        ("deep", "no_such_kit.inner:X"),
    )}  # fmt: skip
    assert {name for name, point in points.items() if not entry_points.point_fault(point)} == {"there"}


def test_a_module_is_parsed_once_for_all_its_entry_points_and_again_where_it_changed(monkeypatch, tmp_path):
    from importlib.metadata import EntryPoint

    monkeypatch.syspath_prepend(str(tmp_path))
    (file := tmp_path / "many_kit.py").write_text("class There: ...\n")
    parsed = []
    monkeypatch.setattr(
        entry_points.ast, "parse", lambda text, parse=entry_points.ast.parse: (parsed.append(text), parse(text))[1]
    )
    points = [EntryPoint(f"p{n}", "many_kit:There", "sgcad.decoder") for n in range(300)]
    assert not any(map(entry_points.point_fault, points))
    assert len(parsed) == 1
    file.write_text("class Elsewhere: ...\n")
    assert entry_points.point_fault(points[0]) == entry_points.GONE


def test_a_strangers_code_is_part_of_its_identity_and_ours_is_not(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(str(tmp_path))
    seen = []
    for number in (1, 2):
        for name in ("strange_pack", "strange_pack.inner"):
            sys.modules.pop(name, None)
        folder = tmp_path / "strange_pack"
        folder.mkdir(exist_ok=True)
        (folder / "helper.py").write_text(f"VALUE = {number}\n")
        (folder / "__init__.py").write_text("class Plug: ...\n")
        importlib.invalidate_caches()
        foreign_plugins._about.cache_clear()
        seen.append(foreign_plugins.code_fingerprint(importlib.import_module("strange_pack").Plug))
    assert seen[0].split()[0] == "strange_pack"
    assert seen[0] != seen[1]  # a helper beside the plugin counts
    assert foreign_plugins.code_fingerprint(registry.plugin_class("decoder", "cad")) == ""


def test_a_module_that_cannot_be_imported_is_named(monkeypatch):
    from importlib.metadata import EntryPoint

    point = EntryPoint("ghost", "plugins.decoder.ghost:Ghost", "sgcad.decoder")
    monkeypatch.setattr(registry, "catalogue", lambda kind: {"ghost": point})
    registry.plugin_class.cache_clear()
    with pytest.raises(ConfigError, match=r"decoder 'ghost' \(plugins.decoder.ghost:Ghost\) cannot be imported"):
        registry.plugin_class("decoder", "ghost")
    registry.plugin_class.cache_clear()

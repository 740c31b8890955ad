"""Promises that every installed plugin keeps, whoever wrote it."""

import pytest
from pydantic import ValidationError

from sgcad_core import registry
from sgcad_core.errors import ConfigError

INSTALLED = [(kind, name) for kind in registry.KINDS for name in registry.catalogue(kind)]


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


def test_an_unknown_plugin_names_the_nearest_and_all():
    with pytest.raises(ConfigError, match=r"unknown decoder 'greedi'. Did you mean 'greedy'\? Installed: .*cad"):
        registry.plugin_class("decoder", "greedi")


def test_a_module_that_cannot_be_imported_is_named(monkeypatch):
    from importlib.metadata import EntryPoint

    point = EntryPoint("ghost", "plugins.decoder.ghost:Ghost", "sgcad.decoder")
    monkeypatch.setattr(registry, "catalogue", lambda kind: {"ghost": point})
    registry.plugin_class.cache_clear()
    with pytest.raises(ConfigError, match=r"decoder 'ghost' \(plugins.decoder.ghost:Ghost\) cannot be imported"):
        registry.plugin_class("decoder", "ghost")
    registry.plugin_class.cache_clear()

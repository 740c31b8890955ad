"""How the writers of a config speak to its model. Knows configs; no case and no file."""

from __future__ import annotations

from sgcad_core.case.records import Context, Generation, Query
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError
from sgcad_core.interfaces import Ask


def ask_of(config: Config) -> Ask:
    """How writers of this config speak to its model; a later attempt draws with another seed."""
    backbone, decoder = config.backbone, config.decoder
    if backbone is None or decoder is None:  # config.build refuses this pairing
        lack = "backbone" if backbone is None else "decoder"
        raise ConfigError(f"{config.name}: a model is asked, but there is no {lack}: name one, as mini.yaml does")

    def ask(context: Context, query: Query) -> Generation:
        return backbone.generate(context, query, decoder.at(query.attempt), seed=config.seed + query.attempt - 1)

    return ask

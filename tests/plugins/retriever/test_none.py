"""No retrieval gives no passages, whatever is asked."""

from plugins.retriever.none import NoRetrieval


def test_nothing_is_known():
    assert NoRetrieval().retrieve("V1 struck V2.", "road") == ()

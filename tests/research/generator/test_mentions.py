"""Names of vehicles: who is named can be told from the others."""

from random import Random

from research.generator.crash.crash import sample_crash
from research.generator.mentions import Mentions


def test_a_make_or_model_alone_names_one_vehicle() -> None:
    named = 0
    for seed in range(300):
        rng, crash = Random(seed), sample_crash(Random(seed), "crossing")
        mentions = Mentions(rng, crash, ciren=False)
        mentions.mixed = True
        crash.actors[0].model, crash.actors[1].model = (
            ("Ford Taurus", "Ford Focus") if seed % 2 else ("Ford Focus",) * 2
        )
        names = {mentions.name(0) for _ in range(40)}
        named += "the Ford Taurus" in names
        assert not names & {"the Ford", "the Ford Focus"}
    assert named > 100

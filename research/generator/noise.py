# ruff: noqa: E501 - lists of words
"""Spelling slips and lost spaces, at the rates counted in real reports."""

from __future__ import annotations

from random import Random

from research.generator.phrase_notes import MARKS

SLIPS = {
    "road": "raod", "east": "easr", "hospital": "hosptial", "because": "becuase", "waiting": "waitng", "avoid": "avid",
    "approximately": "approxiamtely", "driver": "drdiver", "its": "it's", "through": "thru", "losing": "loosing", "roadway": "trafficway",
    "traveling": "travelling", "vehicle": "vehcile", "lane": "lne", "intersection": "intersecton", "northbound": "northound",
    "struck": "struct", "south": "souht", "left": "lef",
}  # fmt: skip


def slips(rng: Random, text: str, per_word: float = 0.003) -> str:
    """Words replaced by misspellings, letters swapped or doubled words; never inside numbers or names."""
    words = text.split(" ")
    for i, word in enumerate(words):
        bare = word.rstrip(MARKS)
        if rng.random() > per_word or not bare.isalpha() or not bare.islower():
            continue
        words[i] = slip(rng, bare) + word[len(bare) :]
    return " ".join(words)


def slip(rng: Random, word: str) -> str:
    """One misspelling."""
    if word in SLIPS and rng.random() < 0.5:
        return SLIPS[word]
    if len(word) < 4 or rng.random() < 0.2:
        return f"{word} {word}"
    at = rng.randrange(1, len(word) - 2)
    return word[:at] + word[at + 1] + word[at] + word[at + 2 :]


def join(rng: Random, sentences: list[str], breaks: list[int], squeeze: bool) -> str:
    """Sentences to text; `breaks` are indices before which a paragraph starts; squeezed texts lose spaces."""
    out = ""
    for i, text in enumerate(sentences):
        if i and i in breaks and not squeeze:
            out += "\n\n"
        elif i:
            out += "" if squeeze and rng.random() < 0.35 else " "
        out += text
    return out

"""Noun phrases that describe a vehicle: where they stand, and sentences without them. Knows no make and no kind."""

from __future__ import annotations

from sgcad_core.reading.language import rule

_MENTION = rule("vehicles.mention")
_STOP = rule("vehicles.stop")
BRACKETED = rule("vehicles.bracketed")
INTRODUCED = rule("references.introduced")


def descriptions(text: str, vehicle: str) -> list[str]:
    """Noun phrases that describe a vehicle: behind "V1," or "V1 was a", or before "(V1)"."""
    if vehicle not in text:
        return []
    found = [m.group(1) for m in BRACKETED.finditer(text) if m.group(2) == vehicle]
    for mention in rule("common.named_vehicle").given(vehicle=vehicle).finditer(text):
        start = mention.end() + text.startswith((")", "),"), mention.end())
        end = _description_end(text, start)
        if end > start:
            found.append(text[start:end])
    return found


def named_before(text: str, vehicle: str) -> list[str]:
    """Makes, models and body words that a number is given to behind them: "a Ford Escape, V2," or "the van is V1"."""
    if vehicle.lower() not in text.lower() or not rule("vehicles.named_before").within(vehicle=r"V\d+").search(text):
        return []  # one pattern for all vehicles, since one for each takes longer to make than to ask
    found = rule("vehicles.named_before").given(vehicle=vehicle).finditer(text)
    return [" ".join(filter(None, m.group("year", "name", "body", "bodied", "only"))) for m in found]


def introductions(text: str, vehicle: str) -> list[str]:
    """The words that first describe an actor of a report without numbers."""
    return [m.group(1) for m in INTRODUCED.finditer(text) if m.group(2) == vehicle]


def _description_end(text: str, start: int) -> int:
    """Where the description that begins at `start` ends; `start` itself if there is none."""
    lead = rule("vehicles.lead").match(text, start)
    if not lead or _STOP.match(text, lead.end()):
        return start
    at = lead.end()
    for _ in range(16):
        token = rule("vehicles.token").match(text, at)
        if not token or _STOP.match(text, token.start(1)) or _MENTION.match(text, token.start(1)):
            break
        at = token.end()
        if text[at - 1] in ".:" or text[at : at + 1] == ";":
            break
    own = rule("vehicles.indefinite").match(text, start)
    return start if not own and rule("vehicles.another").match(text, at) else at


def without_descriptions(text: str) -> str:
    """ "V1, a 2001 Ford Focus, was" -> "V1 was"; "V1 was a 2001 Ford Focus that stopped" -> "V1 stopped"."""
    out, at = "", 0
    for mention in _MENTION.finditer(text):
        if mention.start() < at:
            continue
        end = _description_end(text, mention.end())
        out += text[at : mention.end()]
        at = mention.end()
        if end > at:
            out, at = _join(out, text, at, end)
    return out + text[at:]


def _join(out: str, text: str, start: int, end: int) -> tuple[str, int]:
    """Glue what follows a dropped description to its mention."""
    dropped = text[start:end]
    was = rule("vehicles.was").match(dropped)
    tail = rule("vehicles.relative").match(text[end:])
    skip = tail.end() if tail else 0
    rest = text[end + skip :]
    if was and rule("vehicles.verb").match(rest):
        return f"{out} {was.group(1)} ", end + skip
    if dropped.endswith("."):
        return f"{out}.", end
    return f"{out} ", end + skip

"""How two actors nearly touch: the conflict, the evasion, and how far they pass each other."""

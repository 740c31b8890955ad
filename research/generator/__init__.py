"""Random, physically sensible crashes as reports: narrative, facts told, and the answers to learn.

`report.make_report(seed)` is the way in. Knows no pixels (the renderer draws) and no tokens.
"""

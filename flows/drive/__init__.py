"""Scripted crashes driven by drivers: `sgcad drive`, `sgcad vary`, and the stage `drive` of a config."""

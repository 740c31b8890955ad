"""Written crashes handed over to drivers: `sgcad drive`, and the stage `drive` of a config."""

"""The built-in plugins: one folder for each kind, one file for each plugin. A kind never imports another kind."""

"""How it is done: one folder per plugin kind, one file per choice. A kind never imports another kind."""

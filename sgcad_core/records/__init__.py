"""The frozen records that the parts of the project hand to one another. Knows no reader, no file format and no
plugin."""

"""Broken and hostile input by the thousand: made from seeds, given to every reader."""

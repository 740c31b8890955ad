"""One case: from a report to its folder, revised, explained, in words."""

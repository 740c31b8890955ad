"""The roads of a report: names, lanes, medians, speed limits, work zones."""

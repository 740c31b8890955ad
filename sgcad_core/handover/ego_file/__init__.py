"""A crash as a file in which one vehicle belongs to the tester: `ego.xosc` and the scripts that start it."""

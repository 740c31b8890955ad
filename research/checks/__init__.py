"""Checks of what the project ships that only its developers run, each through a target of the Makefile."""

"""Scenario files and catalogs read into elements, with expressions and distributions."""

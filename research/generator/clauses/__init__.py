"""Clauses of made reports, fact by fact."""

"""Kinds of attack on the readers of reports: texts, PDFs, pictures."""

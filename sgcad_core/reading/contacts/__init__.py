"""Contacts: striker, struck, areas and order; near crashes; the course after the first contact."""

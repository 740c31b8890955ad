"""Families of one crash: what a report leaves open, as parameters, and the hardest members for a driver."""

"""Studies: several arms over the same cases, planned whole, with shared stages computed once.

Knows configs and batches; how results are told stands in flows/results.
"""

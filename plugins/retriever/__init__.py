"""A query -> passages. One file per choice."""

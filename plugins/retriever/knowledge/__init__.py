"""What the `lancedb` retriever knows and how it keeps it: sources of chunks, embedders, the index on disk.

Private to the retriever kind. Knows no prompt, no writer and no flow.
"""

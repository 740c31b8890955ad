"""The knowledge base of the `lancedb` retriever: sources of chunks, embedders, the index on disk.

Private to the retriever kind. Knows no prompt, no writer and no flow.
"""

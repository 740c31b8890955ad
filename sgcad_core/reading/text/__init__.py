"""A report as plain text: spelling, units, sentences, forms, redactions, and phrases that need no context."""

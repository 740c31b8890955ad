"""Facts with the sentences that they were read from."""

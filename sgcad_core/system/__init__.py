"""Files, folders, locks and processes of the machine. Knows nothing of crashes."""

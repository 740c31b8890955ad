"""Who drives the ego once a crash is handed over: one file a driver."""

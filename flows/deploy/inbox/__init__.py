"""The inbox deployment: which reports are ready, which worker takes them, where they go afterwards."""

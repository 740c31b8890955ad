"""Models behind HTTP: requests with retries, three servers' protocols, and contrast by draft and verify."""

"""A reconstructed crash handed over: one road user gets a driver, and the others keep the conflict."""

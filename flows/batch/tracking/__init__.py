"""What is logged of finished cases, and when."""

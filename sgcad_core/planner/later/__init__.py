"""What vehicles meet and do after the first contact, beside running out: later contacts, driving away."""

"""What follows the first contact: impulse, sliding, later contacts, rest."""

"""How two actors come to touch, or nearly: options, timing, the search for the declared contact."""

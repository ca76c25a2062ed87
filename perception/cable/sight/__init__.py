"""One learned look at a whole image: cable, ends, connectors, crossings, tangles."""

"""The nodes that tick, and how they are built and ticked."""

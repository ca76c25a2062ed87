"""Images to distributions; it knows no robot and no simulator."""

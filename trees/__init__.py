"""Trees, missions and cells in YAML, packaged as data."""

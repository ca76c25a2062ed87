"""The monitoring protocol of Groot2, answered out of a recording that may still grow."""

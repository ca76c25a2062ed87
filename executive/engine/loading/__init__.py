"""From names and files to a checked program."""

"""The inspector in the terminal."""

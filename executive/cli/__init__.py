"""The `cellwright` command: parse, call, print, exit code."""

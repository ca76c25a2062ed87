"""The inspector in a browser: a page on loopback that reads recordings, live ones too."""

"""A cell as a service: missions come in one at a time, over HTTP or OPC UA."""

"""The flight recorder: every run is one MCAP file that any MCAP viewer opens."""

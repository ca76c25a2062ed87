"""Each table of results as one command: `python -m benchmarks NAME`."""

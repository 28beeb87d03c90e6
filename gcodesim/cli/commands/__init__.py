"""One file for each command: `add_parser` declares it, `run` carries it out and returns the exit status."""

"""Is the harness to be believed? Equal codes, and slowdowns of known size, put to it and to other tools: `make measuring`."""

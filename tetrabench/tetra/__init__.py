"""The tetra family: its interface, and everything that is written only against it."""

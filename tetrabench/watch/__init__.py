"""See a simulation of colliding objects: in a window, or recorded as a film or a picture, with the leaves of its structure."""

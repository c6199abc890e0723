"""The polygon family: the interface to a stored mesh of polygons, and everything that is written only against it."""

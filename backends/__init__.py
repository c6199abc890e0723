"""The contestants: interchangeable ways to store the same thing, by family."""

"""Slot policies: how free slots are found, skipped and filled. One file each, all of the same shape."""

"""Volumes that are read block by block, and their surfaces, which never have to fit in memory as a whole."""

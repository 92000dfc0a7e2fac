"""Volumes that are read a block at a time, and surfaces of them that are never in one place."""

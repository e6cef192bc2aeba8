"""Peaks of sampled signals, between their samples."""

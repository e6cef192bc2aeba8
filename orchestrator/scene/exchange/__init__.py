"""Scenes in files of other formats than their own."""

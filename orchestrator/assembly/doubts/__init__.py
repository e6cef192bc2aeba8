"""Sentences on what is hardly meant, a module for each part of a scene."""

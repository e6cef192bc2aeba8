"""Analyses of scenes and results: each public module is one; a scene or a result in, records out."""

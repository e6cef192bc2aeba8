"""Scenes, the master algorithm, results and the command line."""

"""Analyses of scenes and results: functions that take one and give records; no terminal, no pictures."""

"""Runs that follow a prescribed motion: what they show over time, and when they are quiet again."""

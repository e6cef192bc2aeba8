"""Torque margin of every hinge line over its travel, and restarts from where it was stopped."""

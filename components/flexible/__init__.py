"""Flexible bodies: finite elements of panels and frames, their reduction to modes, and stresses from modes."""

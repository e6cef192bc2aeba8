"""A wing as one FMU whose values a reader changes: which keys of its scene slide, and what they change in its data."""

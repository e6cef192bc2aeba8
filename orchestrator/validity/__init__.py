"""Plausibility of scenes, and limits of validity of models: warnings, one module per subject."""

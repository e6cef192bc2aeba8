"""Matrices and nodes as text, those of CalculiX among them."""

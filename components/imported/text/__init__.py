"""Matrices and nodes that CalculiX, Abaqus and Ansys write as text."""

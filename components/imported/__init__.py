"""Finite-element models of other programs: their files, the check whether they agree, and what bodies need of them."""

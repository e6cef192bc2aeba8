"""The documents as HTML: the pages of `docs`, references from the declarations, and a gallery of the examples."""

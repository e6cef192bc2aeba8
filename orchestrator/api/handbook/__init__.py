"""The documents: written pages in `pages`, and pages generated from the declarations."""

"""The documents: pages that people wrote in `pages`, and what is generated beside them from the declarations."""

"""Tables that say how a body is built, the catalogue of such bodies, and the definitions that follow from them."""

"""One coupled step: wrenches at all ports for which both sides agree."""

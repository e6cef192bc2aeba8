"""What every component keeps to: declarations, registry, states and steps; and the frames all of them turn in."""

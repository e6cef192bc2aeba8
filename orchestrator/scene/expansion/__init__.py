"""What a scene's tree is short for: arrays of like parts, joints by their name; before it is read."""

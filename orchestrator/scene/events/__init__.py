"""What happens in mid-run, as a scene file says it."""

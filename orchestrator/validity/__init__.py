"""Whether a scene is plausible, and a run within the validity of its models: warnings, a module for each subject."""

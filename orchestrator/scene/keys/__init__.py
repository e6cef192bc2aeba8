"""Every key of scene files with unit, default and meaning, from the models that read them."""

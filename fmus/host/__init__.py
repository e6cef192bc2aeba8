"""FMUs in processes of their own: whoever loads a binary that was not compiled here does it by `FmuProcess`."""

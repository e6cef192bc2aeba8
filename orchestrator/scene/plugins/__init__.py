"""What scenes use that is kept outside of the package: loaded, and tried before a run."""

"""A scene as one FMU: its components and the master that couples them."""

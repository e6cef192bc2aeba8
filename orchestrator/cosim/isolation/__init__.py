"""An FMU in a process of its own, called through shared memory: what it breaks is its own process."""

"""Everything wrong with an FMU, as sentences; a short run of it in a process of its own."""

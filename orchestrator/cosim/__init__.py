"""The co-simulation: time, events and the coupling of participants, of which it knows nothing but FMI."""

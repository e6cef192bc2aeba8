"""FMUs of other tools that take signals of the participants and set parameters of them, each at a step of its own."""

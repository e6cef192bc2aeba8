"""The wing inside the page: its FMU in WebAssembly, sliders, and what follows from a new run."""

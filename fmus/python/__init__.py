"""The Python back end: the code that a PythonFMU carries, and the slave that runs it."""

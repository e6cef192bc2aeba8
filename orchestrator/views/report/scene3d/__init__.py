"""The structure in space and interactive plots as a part of the report: data from Python, pictures by the browser."""

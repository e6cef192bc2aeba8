"""Names of matrices in files of finite elements, and of the keys of `[body.import]` that have files."""

OP4_NAMES = {
    "stiffness": "kaa",
    "mass": "maa",
    "coordinates": "nodes",
    "dofs": "dofs",
    "sample_masses": "smass",
    "sample_positions": "spos",
    "sample_displacement": "sdisp",
    "recovered_nodes": "rnodes",
    "recovered_motion": "rmotion",
    "stress": "stress",
    "force": "force",
    "moment": "moment",
    "force_per_length": "flow",
}
"""What the matrices are called in op4 files, which have names of eight letters."""
OUTPUTS = {"stress": "Pa", "force": "N", "moment": "N.m", "force_per_length": "N/m"}
"""Matrices with rows of outputs, and the units of these."""
WHOLE = "file"
"""The key of a file that holds everything."""
NAMES = (WHOLE, *OP4_NAMES)

"""The coupled step and the loop around it in C, and how they are called."""

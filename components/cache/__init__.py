"""What is dear to compute, kept on disk from one run to the next."""

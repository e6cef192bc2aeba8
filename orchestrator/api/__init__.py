"""What `import orchestrator` offers, one module a subject; nothing is computed here."""

"""Pictures and pages of results and analyses."""

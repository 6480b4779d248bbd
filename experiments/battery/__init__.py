"""The battery: every stage, one growing mind, populations beside infants."""

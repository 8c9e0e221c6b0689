"""Long work and stored results: an embedded store that survives a restart, and the jobs that run from it."""

"""Charts of results, as Altair charts."""

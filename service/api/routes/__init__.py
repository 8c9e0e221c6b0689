"""Routes, a file for each resource. Each says what is asked for and leaves the rest to `Services`."""

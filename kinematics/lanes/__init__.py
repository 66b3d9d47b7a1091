"""Several problems at once: a compiled value of eight floats, and what is computed with it."""

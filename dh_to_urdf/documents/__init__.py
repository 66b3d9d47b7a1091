"""Documents of tables: JSON, YAML and CSV in, with every fault at its cell, and out."""

"""Documents of tables: JSON, YAML and CSV in, with every problem at its cell, and out."""

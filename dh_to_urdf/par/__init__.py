"""Reader and writer of SYMORO ``.par`` files."""

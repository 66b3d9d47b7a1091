"""SYMORO ``.par`` files, in and out."""

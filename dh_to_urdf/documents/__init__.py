"""Readers and writers of documents: JSON, YAML and CSV."""

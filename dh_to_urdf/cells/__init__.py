"""Cells of tables: numbers as people write them, names, sums and variables."""

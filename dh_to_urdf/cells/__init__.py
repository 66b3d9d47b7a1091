"""Cells of tables: numbers, names, sums and joint variables."""

"""Runs the service: its address, its worker processes, and how they stop."""

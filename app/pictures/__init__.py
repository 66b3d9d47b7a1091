"""Pictures without a browser: SVG from NumPy arrays."""

"""Request fields, each declared once: its type, unit, reader, bounds, text and example."""

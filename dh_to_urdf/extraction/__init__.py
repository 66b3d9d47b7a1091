"""From axes to D-H: chains of URDFs and drawings, conversion, comparison, in words."""

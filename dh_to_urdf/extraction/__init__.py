"""D-H tables from joint axes: chains of URDFs and drawings, conversion, comparison."""

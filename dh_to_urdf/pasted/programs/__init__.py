"""Python and MATLAB programs that make robots, read by their syntax trees; none is run."""

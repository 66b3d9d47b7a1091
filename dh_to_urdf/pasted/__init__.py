"""Tables as text: LaTeX, Markdown, TSV, MATLAB and Python, in and out."""

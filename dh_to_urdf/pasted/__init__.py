"""Tables as text: readers and writers of LaTeX, Markdown, TSV and MATLAB, reader of Python."""

"""The lab sheets at ``/labs``: the Markdown of ``labs/`` as HTML, in English and French."""

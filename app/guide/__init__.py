"""The guide at ``/guide``: the Markdown pages of ``docs/`` as HTML, readable offline."""

"""Exercises with numbers of one's own: each seed draws other lengths and poses.

What is asked stands in ``data``, the words in ``texts``, one file a language. Nothing is kept: the
seed says everything.
"""

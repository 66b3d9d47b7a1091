"""Closed forms of many targets in lanes, where nothing is at the edge of having solutions."""

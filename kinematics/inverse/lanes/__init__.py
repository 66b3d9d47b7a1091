"""Damped least squares in lanes: many targets, or many starts of one target, at once."""

"""Paired benchmarks: only ratios within one run mean anything on a shared machine."""

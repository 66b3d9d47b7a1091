"""The program of a whole path: one sparse optimisation over all samples, in a process of its own.

The modules for that process import CasADi and NumPy only, so that it starts fast and stays small.
"""

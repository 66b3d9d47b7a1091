"""Work in processes of their own: bounded in number, time and memory, and killed when unwanted.

A module does the work: its ``prepare()`` imports what that needs, and returns a function that
yields the answers to a task, each better than the one before.
:class:`kinematics.processes.pool.ProcessPool` runs it.
"""

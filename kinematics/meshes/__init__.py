"""Meshes that people upload: read by libraries in a process of its own, and written anew.

The process has bounds of memory and time, opens no file, and is killed when it exceeds them. What
comes of a file is a glTF binary with positions and triangles only, simplified, and a convex hull.
"""

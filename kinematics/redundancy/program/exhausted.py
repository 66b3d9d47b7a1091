"""Memory that the solver does not get: its libraries hide that, and give an answer that is none."""

from __future__ import annotations

import ctypes
import os
import re
import tempfile
from contextlib import suppress

CPP_LIBRARIES = "libstdc++.so.6", "libc++.1.dylib"
SET_NEW_HANDLER = "_ZSt15set_new_handlerPFvvE"
"""Name of ``std::set_new_handler(void (*)())``."""
ERRORS = 2
"""Level of IPOPT's messages: errors and strong warnings."""
_NO_MEMORY = re.compile(rb"out of memory|(Error|INFO\(1\)) ?= ?-(8|9|13)\b")
"""MUMPS: its workspace is too small (-8, -9), an allocation failed (-13)."""


def abort_without_memory() -> None:
    """Have the process abort where C++ finds no memory.

    CasADi and IPOPT take a failed allocation for a point at which a function has no value: they go
    on, and look for others until the time is up.
    """
    for name in CPP_LIBRARIES:
        with suppress(OSError):  # the library of another system
            set_handler = ctypes.CDLL(name)[SET_NEW_HANDLER]
            set_handler.argtypes, set_handler.restype = [ctypes.c_void_p], ctypes.c_void_p
            set_handler(ctypes.cast(ctypes.CDLL(None).abort, ctypes.c_void_p))


class Complaints:
    """What IPOPT says of errors: it writes them to a file, anew for each solution.

    Attributes:
        options: Options of IPOPT by which it does.
    """

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile()  # noqa: SIM115  as long as the solver
        name = f"/dev/fd/{self._file.fileno()}"
        self.options = {"output_file": name, "file_print_level": ERRORS}

    def are_about_memory(self) -> bool:
        """Return whether the linear solver had too little memory."""
        size = os.fstat(self._file.fileno()).st_size
        return _NO_MEMORY.search(os.pread(self._file.fileno(), size, 0)) is not None

"""Install into the checkout's ``.venv`` what ``requirements.lock`` names: ``make`` calls this.

``python install/set_up.py run build`` installs what running takes and the package itself, editable;
without a table, everything that developers need. Run by the environment's own Python. uv does the
work, put there by pip; where it cannot (it reads no settings of pip), pip does.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import prune
from locked import ROOT, locked

ENVIRONMENT = ROOT / ".venv"
UV = ENVIRONMENT / "bin" / "uv"
HASHED = ("--require-hashes", "--no-deps")
EDITABLE = ("--no-deps", "--no-build-isolation", "--editable", str(ROOT))


def main() -> None:
    """Install, then prune."""
    site = prune.site_packages(Path(sys.prefix), Path(prune.sysconfig.get_path("purelib")))
    with tempfile.TemporaryDirectory(prefix=".cache-", dir=ENVIRONMENT) as cache:
        # What uv unpacks goes again, unless the user says where to keep it for other checkouts.
        os.environ.setdefault("UV_CACHE_DIR", cache)
        # As pip does: certificates that this machine trusts, not those that uv brings.
        os.environ.setdefault("UV_SYSTEM_CERTS", "1")
        # Without the page: it is built beside the service.
        os.environ["HATCH_BUILD_NO_HOOKS"] = "true"
        if not UV.exists():
            pip("install", *requirements("uv"))
        install(*requirements(*sys.argv[1:]))
        install(*EDITABLE)
    prune.prune(site, ROOT / "robots" / "library")


def requirements(*tables: str) -> tuple[str, ...]:
    """Write what the lock has for some tables into a file; return the options that name it."""
    path = ENVIRONMENT / f"{'-'.join(tables) or 'all'}.txt"
    path.write_text(locked(*tables), encoding="utf-8")
    return (*HASHED, "--requirement", str(path))


def install(*options: str) -> None:
    """Install with uv, and with pip where uv fails."""
    command = [str(UV), "pip", "install", "--python", sys.executable, *options]
    if not sys.stderr.isatty():
        command.append("--quiet")
    if not shutil.which(command[0]) or subprocess.run(command, check=False).returncode:
        print("uv cannot install this; trying pip", file=sys.stderr)
        pip("install", *options)


def pip(*arguments: str) -> None:
    """Run pip.

    Raises:
        SystemExit: It failed; its output says why.
    """
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments, "--quiet"]
    if subprocess.run(command, check=False).returncode:
        sys.exit(f"{' '.join(command)} failed")


if __name__ == "__main__":
    main()

"""Writes into the documentation what its commands print: ``python -m tests.docs.rewrite [page …]``.

Look at the difference before you commit it.
"""

import json
import sys
import tempfile
from pathlib import Path

from tests.conftest import running_server
from tests.docs.blocks import PAGES, ROOT, run, runs_of


def rewritten(page: str, server: str, folder: Path) -> str:
    """A page with the outputs of now."""
    parts, end = [], 0
    for block, shown in runs_of(page):
        printed = run(block, server, folder)
        if shown is None:
            continue
        if shown.language == "json":
            printed = json.dumps(json.loads(printed), indent=2, ensure_ascii=False)
        parts += [page[end : shown.begin], printed.strip("\n"), "\n"]
        end = shown.end
    return "".join([*parts, page[end:]])


def main() -> None:
    for name in sys.argv[1:] or PAGES:
        with tempfile.TemporaryDirectory() as work, running_server(Path(work, "data")) as (one, _):
            folder = Path(work, "page")
            folder.mkdir()
            (folder / ".venv").symlink_to(Path(sys.executable).parent.parent)
            path = ROOT / name
            path.write_text(rewritten(path.read_text(), one, folder))


if __name__ == "__main__":
    main()

"""Types that openapi-typescript makes of the OpenAPI document; ``make api-types`` writes them.

``python -m tests.app.openapi.typescript FILE`` writes those of the service as it stands.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import hatch_build
from app.main import create_app
from app.settings import Settings

GENERATORS = {"openapi-typescript": "7.13.0", "typescript": "5.9.3"}
PAGE = Path(__file__).parents[3] / "web" / "src" / "api" / "schema.ts"
"""Where the page has them."""


def generate(document: dict[str, Any], folder: Path) -> str:
    """Write ``schema.ts`` of a document into a folder with compiler and generator; return it."""
    (folder / "openapi.json").write_text(json.dumps(document))
    scripts = {
        "types": "openapi-typescript openapi.json -o schema.ts --default-non-nullable false",
        "check": "tsc --noEmit --strict use.ts",
    }
    (folder / "package.json").write_text(json.dumps({"private": True, "scripts": scripts}))
    wanted = [f"{name}@{version}" for name, version in GENERATORS.items()]
    hatch_build.run_npm(folder, "install", "--no-audit", "--no-fund", "--ignore-scripts", *wanted)
    hatch_build.run_npm(folder, "run", "--silent", "types")
    return (folder / "schema.ts").read_text()


def schemas_of(document: dict[str, Any]) -> dict[str, Any]:
    """Return the part of a document that the page uses: its schemas, without endpoints."""
    kept = {key: document[key] for key in ("openapi", "info")}
    return {**kept, "paths": {}, "components": {"schemas": document["components"]["schemas"]}}


def main() -> None:
    """Write the types of this build into the file that is named."""
    with tempfile.TemporaryDirectory() as folder:
        document = create_app(Settings(data_dir=Path(folder) / "data")).openapi()
        Path(sys.argv[1]).write_text(generate(schemas_of(document), Path(folder)))


if __name__ == "__main__":
    main()

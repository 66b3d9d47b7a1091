"""What is done before the first request."""

import asyncio

import pytest

from app.access.keys import Scope, new_key
from app.main import create_app
from app.settings import Settings
from robots.shipped import shipped_ids


@pytest.mark.parametrize("protected", [False, True])
def test_the_library_is_in_memory_and_every_example_was_answered(tmp_path, protected):
    """An example that is not answered with 200 would stop the service as it starts."""
    _, key = new_key("a", Scope.READ)
    access = {"api_keys": key.line, "rate_limit": "1/hour"} if protected else {}
    app = create_app(Settings(data_dir=tmp_path, preload=True, **access))

    async def start() -> set[str]:
        async with app.router.lifespan_context(app):
            store = app.state.services.store
            return {name for name in shipped_ids() if store.in_memory(name) is not None}

    assert asyncio.run(start()) == set(shipped_ids())

"""What is done before the first request."""

import asyncio

from app.main import create_app
from app.settings import Settings
from robots.shipped import shipped_ids


def test_the_library_is_in_memory_and_every_example_was_answered(tmp_path):
    """An example that is not answered with 200 would stop the service as it starts."""
    app = create_app(Settings(data_dir=tmp_path, preload=True))

    async def start() -> set[str]:
        async with app.router.lifespan_context(app):
            store = app.state.services.store
            return {name for name in shipped_ids() if store.in_memory(name) is not None}

    assert asyncio.run(start()) == set(shipped_ids())

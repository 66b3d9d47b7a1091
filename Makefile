# make run    set everything up and serve on port 8000
# make test   set everything up and run the tests
# make help   the rest

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RUNNING := $(VENV)/.running
STAMP := $(VENV)/.installed

# Some environments forbid byte code; here each server that a test starts would compile all anew.
unexport PYTHONDONTWRITEBYTECODE

# Both cores; a worker that has nothing left takes tests from the other. For one file pytest alone
# is quicker: .venv/bin/python -m pytest tests/robots
PYTEST := $(BIN)/python -m pytest -n 2 --dist worksteal

.PHONY: help install page kernels run test check messages api-types lint lock bench bench-peers torture image-test clean

help:
	@echo "make run         set up .venv and serve on http://localhost:8000"
	@echo "make test        set up .venv and run the tests of the libraries, and scenes of service and page"
	@echo "make check       run all tests; with REST=1 those that make test leaves out"
	@echo "make install     set up .venv with all that developers need"
	@echo "make page        build the page anew if web/ has changed"
	@echo "make lint        ruff, strict types, import contract"
	@echo "make api-types   write the page's types anew from the OpenAPI document"
	@echo "make messages    bring the catalogues of other languages up to the sources"
	@echo "make bench       paired benchmarks"
	@echo "make bench-peers inverse kinematics, all solutions too, beside other libraries, in .venv-peers"
	@echo "make torture     the long campaigns: documents, requests, schemas, the store, load (hours)"
	@echo "make image-test  build the Docker image and test it (as root, on Debian)"
	@echo "make lock        resolve the dependencies anew"
	@echo "make clean       remove .venv"

install: $(STAMP)

# What running takes. Quick the second time, as all of these.
$(RUNNING): requirements.lock pyproject.toml install/locked.py install/prune.py install/set_up.py
	@$(PYTHON) -c 'import sys; sys.exit("Denavit needs Python 3.11 or newer; run: make PYTHON=python3.12 …" if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python install/set_up.py run build
	@touch $@

# What developers need besides, and compiled kernels.
$(STAMP): $(RUNNING)
	$(BIN)/python install/set_up.py
	$(BIN)/python -m kinematics.warm --jobs 2
	@touch $@

# Quick where web/ has not changed.
page: $(STAMP)
	@$(BIN)/python hatch_build.py

# Quick where kinematics/ has not changed.
kernels: $(STAMP)
	@$(BIN)/python -m kinematics.warm --jobs 2

# Serves at once: the page and the kernels come beside, the first time.
run: $(RUNNING)
	@$(BIN)/python install/page.py & \
	DENAVIT_LOG_FORMAT=$${DENAVIT_LOG_FORMAT:-text} exec $(BIN)/denavit serve

test: page kernels
	$(PYTEST) -m first

check: page kernels
	$(PYTEST) $(if $(REST),-m "not first")

# New sentences into the catalogues of other languages; the compiled ones anew.
messages: $(STAMP)
	$(BIN)/python -m tests.messages.update

# The types of answers and requests that the page is checked with.
api-types: kernels
	$(BIN)/python -m tests.app.openapi.typescript web/src/api/schema.ts

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python hatch_build.py lint
	@! grep -nE 'https?://|file:|index-url|find-links' requirements.lock bench/requirements-peers.lock

bench: $(STAMP)
	$(BIN)/python -m bench

bench-peers: bench/requirements-peers.lock
	$(PYTHON) -m venv .venv-peers
	.venv-peers/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r bench/requirements-peers.lock
	.venv-peers/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	.venv-peers/bin/python -m bench.peers
	.venv-peers/bin/python -m bench.all_solutions

torture: $(STAMP)
	$(BIN)/python -m tests.torture.urdf --count 100000
	$(BIN)/python -m tests.torture.meshes --count 2000
	$(BIN)/python -m tests.torture.tables --count 50000
	$(BIN)/python -m tests.torture.requests --count 50000
	$(BIN)/python -m tests.torture.schema
	$(BIN)/python -m tests.torture.store --kills 300
	$(BIN)/python -m tests.torture.children --requests 10000 --kills 300
	$(BIN)/python -m tests.torture.memory
	$(BIN)/python -m tests.torture.classroom --drags 600
	$(BIN)/python -m tests.torture.six_joints --arms 1000
	$(BIN)/python -m tests.torture.redundant_arms --targets 500
	$(BIN)/python -m tests.torture.soak --minutes 10

image-test:
	./docker/image-test.sh

lock: $(STAMP)
	$(BIN)/uv pip compile pyproject.toml --extra dev --universal --python-version 3.11 --generate-hashes --no-header --upgrade --output-file requirements.lock

clean:
	rm -rf $(VENV) .venv-peers

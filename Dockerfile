FROM docker.io/library/python:3.11-slim-bookworm AS build
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install -y --no-install-recommends binutils \
    && rm -rf /var/lib/apt/lists/*
ENV PIP_CACHE_DIR=/var/cache/pip
WORKDIR /src

# The dependencies, in a layer of their own that changes with the lock only.
COPY pyproject.toml requirements.lock ./
COPY install/locked.py install/
RUN --mount=type=cache,target=/var/cache/pip \
    python -m venv --without-pip /opt/denavit \
    && python install/locked.py run > run.txt \
    && python -m pip --python /opt/denavit/bin/python install \
        --require-hashes --no-deps --only-binary :all: --no-compile -r run.txt \
    && python -m pip --python /opt/denavit/bin/python check
COPY install/prune.py install/
COPY docker/strip.py docker/
COPY robots/library robots/library
RUN /opt/denavit/bin/python -B install/prune.py \
    && /opt/denavit/bin/python -B docker/strip.py

# The service itself, below /app as it will lie below /.
RUN --mount=type=cache,target=/var/cache/pip \
    python install/locked.py build page > build.txt \
    && python -m pip install --require-hashes --no-deps --only-binary :all: -r build.txt

# The page, in a layer that changes with its own sources only; the wheel takes it as it is.
COPY hatch_build.py ./
COPY web web
RUN --mount=type=cache,target=/var/cache/npm \
    mkdir app && npm_config_cache=/var/cache/npm python hatch_build.py

COPY LICENSE README.md SECURITY.md CHANGELOG.md ./
COPY docs docs
COPY labs labs
COPY dh_to_urdf dh_to_urdf
COPY robots robots
COPY kinematics kinematics
COPY app app
RUN python -m pip wheel --no-cache-dir --no-deps --no-build-isolation --wheel-dir dist . \
    && python -m pip --python /opt/denavit/bin/python install \
        --no-cache-dir --no-deps --no-index --no-compile --root /app dist/*.whl


FROM docker.io/library/python:3.11-slim-bookworm
# libgomp1 is Pinocchio's; pip and its like have no business in a running service.
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install -y --no-install-recommends libgomp1 \
    && rm -rf /var/lib/apt/lists/* \
    && python -m pip uninstall -y --root-user-action ignore wheel setuptools pip \
    && groupadd --gid 10001 denavit \
    && useradd --uid 10001 --gid 10001 --no-log-init --no-create-home --home-dir /nonexistent \
        --shell /usr/sbin/nologin denavit \
    && install -d -o 10001 -g 10001 /data

# Kernels for any CPU of the architecture: others would be compiled anew, half a minute, on the next.
ENV PATH=/opt/denavit/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    DENAVIT_HOST=0.0.0.0 \
    DENAVIT_PORT=8000 \
    DENAVIT_DATA_DIR=/data \
    NUMBA_CACHE_DIR=/opt/denavit/kernels \
    NUMBA_CPU_NAME=generic
COPY --from=build /opt/denavit /opt/denavit
COPY --from=build /app/opt/denavit /opt/denavit
# Writes down what the image carries: fails on a licence that is not permissive. Then leaves in the
# image what a first start compiles: bytecode, and kernels in NUMBA_CACHE_DIR.
COPY docker/sbom.py docker/warm_up.py /tmp/
RUN python /tmp/sbom.py /opt/denavit/share/denavit \
    && python -m kinematics.warm --jobs 2 \
    && python /tmp/warm_up.py \
    && rm /tmp/sbom.py /tmp/warm_up.py

USER 10001:10001
VOLUME /data
EXPOSE 8000
HEALTHCHECK --interval=30s --timeout=5s --start-period=30s --retries=3 \
    CMD ["python", "-IS", "-c", "import http.client, os, sys; c = http.client.HTTPConnection('localhost', int(os.environ['DENAVIT_PORT']), timeout=4); c.request('GET', '/health/live'); sys.exit(c.getresponse().status != 200)"]
ENTRYPOINT ["denavit"]
CMD ["serve"]

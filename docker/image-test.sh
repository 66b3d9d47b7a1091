#!/usr/bin/env bash
# Builds the image and tests it by running it, then removes all it made.
#
# With a Docker engine: plain docker. Without one, as root on Debian: buildah and podman, on a base
# image that mmdebstrap makes with the name and the layout of the official one. That base and pip's
# downloads stay in /var/tmp/denavit-image for the next run; delete the directory to start afresh.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly BASE=docker.io/library/python:3.11-slim-bookworm
readonly LIMIT_MIB=500
readonly CACHE=/var/tmp/denavit-image
readonly IMAGE=localhost/denavit:image-test-$$
readonly NAME=denavit-image-test-$$
readonly HARDENED=(--read-only --tmpfs /tmp --cap-drop=all --security-opt no-new-privileges)
work=$(mktemp -d /var/tmp/denavit-image-test.XXXXXX)
trap 'rm -rf "$work"' EXIT

say() { printf '\n== %s\n' "$*"; }
fail() {
  printf 'FAILED: %s\n' "$*" >&2
  engine logs "$NAME" 2>&1 | tail -40 >&2 || true
  exit 1
}
# check WHAT COMMAND...: the command must succeed.
check() {
  local what=$1
  shift
  if "$@"; then echo "ok  $what"; else fail "$what"; fi
}
# refuse WHAT COMMAND...: the command must not succeed.
refuse() {
  local what=$1
  shift
  if "$@" >/dev/null 2>&1; then fail "$what"; else echo "ok  $what"; fi
}

# --- Docker -------------------------------------------------------------------------------------

with_docker() {
  engine() { docker "$@"; }
  build() {
    docker image inspect "$BASE" >/dev/null 2>&1 || docker pull --quiet "$BASE"
    docker build --tag "$IMAGE" .
  }
  start() {
    docker run --detach --name "$NAME" "${HARDENED[@]}" --volume "$NAME:/data" \
      --publish 127.0.0.1::8000 "$IMAGE" >/dev/null
    url=http://$(docker port "$NAME" 8000/tcp | head -1)
  }
  healthy() { # once the engine has run the check by itself
    for _ in $(seq 60); do
      [[ $(docker inspect --format '{{.State.Health.Status}}' "$NAME") == healthy ]] && return
      sleep 1
    done
    return 1
  }
  clean_up() {
    docker rm --force --volumes "$NAME" >/dev/null 2>&1 || true
    docker volume rm "$NAME" >/dev/null 2>&1 || true
    docker image rm "$IMAGE" >/dev/null 2>&1 || true
    rm -rf "$work"
  }
}

# --- buildah and podman -------------------------------------------------------------------------

with_podman() {
  local storage=(--root "$work/storage" --runroot "$work/run")
  local port
  port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
  readonly PORT=$port STORAGE=("${storage[@]}")

  engine() { # podman laments that it has no systemd to time health checks with
    podman "${STORAGE[@]}" --tmpdir "$work/tmp" --runtime runc --cgroup-manager cgroupfs \
      --events-backend file "$@" 2> >(grep -v 'systemd connection' >&2)
  }
  build() {
    make_base
    make_pip_conf
    make_npmrc
    # --format docker: the OCI format has no HEALTHCHECK.
    BUILDAH_ISOLATION=chroot TMPDIR=$CACHE buildah "${STORAGE[@]}" bud --format docker \
      --pull-never "${mounts[@]}" --tag "$IMAGE" .
  }
  start() {
    engine run --detach --name "$NAME" "${HARDENED[@]}" --volume "$NAME:/data" \
      --network host --env "DENAVIT_PORT=$PORT" \
      --ulimit nofile=1024:2048 --ulimit nproc=1024:2048 "$IMAGE" >/dev/null
    url=http://127.0.0.1:$PORT
  }
  healthy() { engine healthcheck run "$NAME"; }
  clean_up() {
    engine rm --force --time 0 --all >/dev/null 2>&1 || true
    buildah "${STORAGE[@]}" rm --all >/dev/null 2>&1 || true
    { awk -v below="$work/" 'index($2, below) == 1 {print $2}' /proc/mounts | sort -r |
      xargs --no-run-if-empty umount; } 2>/dev/null || true
    rm -rf "$work"
  }
}

# The packages that building without an engine takes.
install_tools() {
  local missing=() tool
  for tool in mmdebstrap buildah podman runc curl; do
    command -v "$tool" >/dev/null || missing+=("$tool")
  done
  if ((${#missing[@]})); then
    say "Installing ${missing[*]}"
    apt-get update -q
    apt-get install -qy --no-install-recommends "${missing[@]}"
  fi
}

# Python in /usr/local without bytecode, and an apt that keeps no cache, as in the official image.
make_base() {
  mkdir -p "$CACHE"
  if [[ ! -f $CACHE/base.tar ]]; then
    say "Making a base image with mmdebstrap"
    cat >"$work/docker-clean" <<'APT'
DPkg::Post-Invoke { "rm -f /var/cache/apt/archives/*.deb /var/cache/apt/*.bin || true"; };
Dir::Cache::pkgcache "";
Dir::Cache::srcpkgcache "";
APT
    # shellcheck disable=SC2016  # mmdebstrap gives $1 to its hooks
    mmdebstrap --quiet --variant=minbase --include=ca-certificates,python3.11,python3.11-venv \
      --customize-hook='chroot "$1" python3.11 -m venv /usr/local' \
      --customize-hook="upload $work/docker-clean /etc/apt/apt.conf.d/docker-clean" \
      --customize-hook='find "$1/usr" -name __pycache__ -exec rm -r {} +' \
      --customize-hook='rm -f "$1"/var/cache/apt/*.bin' \
      bookworm "$work/base.tar"
    mv "$work/base.tar" "$CACHE/base.tar"
  fi
  local container
  container=$(buildah "${STORAGE[@]}" from scratch)
  buildah "${STORAGE[@]}" add --quiet "$container" "$CACHE/base.tar" / >/dev/null
  buildah "${STORAGE[@]}" config --env PATH=/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    --cmd python3 "$container"
  buildah "${STORAGE[@]}" commit --quiet --format docker --rm "$container" "$BASE" >/dev/null
}

# This machine's certificates and pip settings, for the build only: a pip.conf made of what pip says
# of its files and of the environment, and every local file or folder that it speaks of.
make_pip_conf() {
  mounts=(--volume /etc/ssl/certs:/etc/ssl/certs:ro)
  local path
  while read -r path; do
    mounts+=(--volume "$path:$path:ro")
  done < <(python3 - "$work/pip.conf" <<'PY'
import ast
import subprocess
import sys
from pathlib import Path

listed = subprocess.run(
    [sys.executable, "-m", "pip", "config", "list"], capture_output=True, text=True
).stdout
sections = {}
for line in listed.splitlines():
    key, _, value = line.partition("=")
    section, _, option = key.rpartition(".")
    # The environment comes first in the list, and wins.
    sections.setdefault(section.replace(":env:", "global"), {}).setdefault(
        option, ast.literal_eval(value).split()
    )
bundle = Path("/etc/ssl/certs/ca-certificates.crt")
if bundle.exists():
    sections.setdefault("global", {}).setdefault("cert", [str(bundle)])
paths = set()
with open(sys.argv[1], "w", encoding="utf-8") as file:
    for section, options in sections.items():
        print(f"[{section}]", file=file)
        for option, words in options.items():
            print(option, "=", "\n    ".join(words), file=file)
            for word in words:
                # An index's pages refer to files beside it.
                local = Path(word[7:]).parent if word.startswith("file:///") else Path(word)
                if local.is_absolute() and local.exists() and bundle.parent not in local.parents:
                    paths.add(str(local))
print(*sorted(paths), sep="\n")
PY
  )
  mounts+=(--volume "$work/pip.conf:/etc/pip.conf:ro")
}

# The same for npm: its registry, and the machine's certificates.
make_npmrc() {
  local home=~root
  {
    if command -v npm >/dev/null; then echo "registry=$(npm config get registry)"; fi
    echo cafile=/etc/ssl/certs/ca-certificates.crt
  } >"$work/npmrc"
  mounts+=(--volume "$work/npmrc:$home/.npmrc:ro")
}

# --- The tests ----------------------------------------------------------------------------------

get() { curl --silent --show-error --fail --max-time 20 "$url$1"; }
answers() { get "$1" >/dev/null; }
wait_until_live() {
  for _ in $(seq 100); do
    curl --silent --fail --max-time 2 --output /dev/null "$url/health/live" && return
    sleep 0.1
  done
  return 1
}
inside() { engine exec "$NAME" "$@"; }
# stop_in_time: a stop must end the service by itself, with status 0, well before the kill.
stop_in_time() {
  local begun=$SECONDS
  engine stop -t 20 "$NAME" >/dev/null
  ((SECONDS - begun < 10)) && [[ $(engine inspect --format '{{.State.ExitCode}}' "$NAME") == 0 ]]
}
size_of() { engine image inspect --format '{{.Size}}' "$1"; }

# From roboticstoolbox-python 1.5.0, its model Puma560.
readonly JOINTS='[-1.467902370861086, 0.8581742786411435, -2.26324276197147, 2.067563913002944,
  1.7220283458702539, 3.6104133428296175]'
readonly TIP='[[0.24803201667924868, 0.4224772031743859, -0.8717758493442989, -0.07617111064191509],
  [0.8448174821673883, -0.5347250978890997, -0.01877475730462677, -0.7232007502474349],
  [-0.4740923333343199, -0.7318347371404568, -0.4895450714573469, 1.0497638183726532],
  [0.0, 0.0, 0.0, 1.0]]'
readonly ARM='{"convention": "modified", "units": {"angle": "deg", "length": "m"}, "joints": [
  {"name": "j1", "type": "revolute", "a": 0, "alpha": 0, "d": 0, "theta": 0},
  {"name": "j2", "type": "revolute", "a": 0.5, "alpha": 0, "d": 0, "theta": 0}],
  "tool": {"xyz": [0.4, 0, 0], "rpy": [0, 0, 0]}}'

test_kinematics() {
  env SERVICE="$url" JOINTS="$JOINTS" TIP="$TIP" python3 - <<'PY'
import json
import os
import urllib.request

client = urllib.request.build_opener(urllib.request.ProxyHandler({}))


def post(path, body):
    request = urllib.request.Request(
        os.environ["SERVICE"] + path,
        json.dumps(body).encode(),
        {"Content-Type": "application/json"},
    )
    return json.load(client.open(request, timeout=30))


def distance(a, b):
    return max(abs(x - y) for row, other in zip(a, b) for x, y in zip(row, other))


def fk(q):
    (pose,) = post("/v1/robots/puma560/fk", {"q": q})["poses"].values()
    return pose["matrix"]


q, T = json.loads(os.environ["JOINTS"]), json.loads(os.environ["TIP"])
error = distance(fk(q), T)
assert error < 1e-12, f"FK is {error} off"
body = {"target": {"matrix": T}, "time_budget_ms": 5000, "random_seed": 0}
found = post("/v1/robots/puma560/ik", body)
assert found["status"] == "converged", found
assert distance(fk(found["q"]), T) < 1e-5, found
PY
}

test_page() {
  local html
  html=$(curl --silent --show-error --fail --header 'Accept: text/html' "$url/") || return 1
  answers "/$(grep -o 'assets/index-[^"]*\.js' <<<"$html")"
}

test_library() {
  local ids id
  ids=$(inside denavit robots | awk '{print $1}')
  [[ $(wc -w <<<"$ids") == $(find robots/library -name '*.yaml' | wc -l) ]] || return 1
  for id in $ids; do
    get "/v1/robots/$id" >/dev/null || return 1
  done
}

test_contents() {
  engine exec --interactive "$NAME" python - <<'PY'
import importlib.util
import shutil
from pathlib import Path

tools = "node npm nginx curl wget pip pip3 pip3.11 cc gcc g++ clang ld as strip make cmake ninja git uv".split()
assert not [name for name in tools if shutil.which(name)]
modules = "pip setuptools wheel hatchling yourdfpy trimesh pytest hypothesis mypy ruff".split()
assert not [name for name in modules if importlib.util.find_spec(name)]
unwanted = {".h", ".hpp", ".a", ".cmake", ".pyx", ".stl", ".dae", ".obj"}
drawn = ("robots/panda_description/meshes/visual/", "robots/ur_description/meshes/ur5/visual/")
left = [
    path
    for path in Path("/opt/denavit").rglob("*")
    if path.suffix.lower() in unwanted and not any(folder in str(path) for folder in drawn)
]
assert not left, left
system = Path("/usr/local").glob("lib/python*/site-packages/*")
assert not [path.name for path in system if path.name.startswith(("pip", "setuptools", "wheel"))]
PY
}

test_confinement() {
  engine exec --interactive "$NAME" python - <<'PY'
from pathlib import Path

status = dict(
    line.split(":\t", 1) for line in Path("/proc/1/status").read_text().splitlines() if ":\t" in line
)
assert status["Uid"].split() == status["Gid"].split() == ["10001"] * 4, status
for kind in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb"):
    assert int(status[kind], 16) == 0, (kind, status[kind])
assert status["NoNewPrivs"].strip() == "1"
PY
}

# The lists name what is installed, and nothing that is not permissive.
test_lists() {
  inside denavit licences --check >"$work/licences" &&
    inside cat /opt/denavit/share/denavit/sbom.cdx.json >"$work/sbom.json" &&
    python3 - "$work" <<'PY'
import json
import sys
from pathlib import Path

work = Path(sys.argv[1])
bill = json.loads((work / "sbom.json").read_text())
assert bill["bomFormat"] == "CycloneDX"
names = {component["name"] for component in bill["components"]}
listed = {line.split()[0] for line in (work / "licences").read_text().splitlines()}
assert listed - {"denavit"} <= names, listed - names
assert {"pin", "fastapi", "python", "libgomp1", "libc6"} <= names
assert "jrl-cmakemodules" not in names
PY
}

# Every line that the service has written is an event in JSON.
test_log() {
  engine logs "$NAME" >"$work/log" 2>&1
  python3 - "$work/log" <<'PY'
import json
import sys

lines = [json.loads(line) for line in open(sys.argv[1], encoding="ascii")]
assert any(line.get("route") == "/v1/robots/{robot_id}/fk" for line in lines)
assert all({"time", "level", "event"} <= line.keys() for line in lines)
PY
}

test_metrics() {
  get /metrics | grep -q '^denavit_http_requests_total{method="POST",route="/v1/robots/{robot_id}/fk",status_class="2xx"} [1-9]'
}

# The service must run the image's kernels: in its own copy of the cache none is new.
test_kernels() {
  engine exec --interactive "$NAME" python - <<'PY'
import os
from pathlib import Path

shipped = Path(os.environ["NUMBA_CACHE_DIR"])
(private,) = Path("/tmp").glob("denavit-kernels-*")


def kernels(folder):
    files = folder.rglob("*.nbc")
    return {(str(path.relative_to(folder)), int(path.stat().st_mtime)) for path in files}


assert kernels(shipped), "the image has no kernels"
assert kernels(private) == kernels(shipped), kernels(private) - kernels(shipped)
PY
}

# Sizes in MiB by what lies in site-packages, the largest first.
print_split() {
  engine exec --interactive "$NAME" python - <<'PY'
import re
import sysconfig
from collections import Counter
from pathlib import Path

site = Path(sysconfig.get_path("purelib"))
sizes = Counter()
for path in site.rglob("*"):
    if path.is_file() and not path.is_symlink():
        parts = path.relative_to(site).parts
        deep = 4 if parts[:2] == ("cmeel.prefix", "lib") and "site-packages" in parts else 2
        name = "/".join(parts[: deep + 1]) if parts[0] == "cmeel.prefix" else parts[0]
        name = re.sub(r"(\.libs|[-.][0-9][^/]*\.dist-info)$", "", name)
        sizes[name] += path.stat().st_size
for name, size in sizes.most_common(24):
    print(f"{size / 2**20:8.1f} MiB  {name}")
print(f"{sum(sizes.values()) / 2**20:8.1f} MiB  in all")
PY
}

run_tests() {
  start
  check "starts" wait_until_live
  check "/health/live" answers /health/live
  check "/health/ready" answers /health/ready
  check "health check of the image" healthy
  check "FK of puma560 is right, IK converges" test_kinematics
  check "kernels come from the image" test_kernels
  check "every robot of the library is there and loads" test_library
  check "docs have their assets" answers /docs-assets/swagger-ui-bundle.js
  check "the page is there for browsers" test_page
  check "the guide" answers /guide/tutorial
  check "the lab sheets" answers /labs/fr/8-optimisation
  check "pictures of the guide" answers /guide/methods.svg
  check "meshes that it draws" answers \
    /v1/robots/panda_urdf/meshes/panda_description/meshes/visual/link0.dae
  check "no pip, compiler, header, other mesh or developer's package inside" test_contents
  check "user 10001, no capability, no new privileges" test_confinement
  check "list of materials, permissive licences" test_lists
  check "metrics" test_metrics
  check "log lines are JSON" test_log
  refuse "root file system is read-only" inside python -c 'open("/opt/denavit/x", "w")'
  check "/tmp and /data are not" inside python -c 'open("/tmp/x", "w"); open("/data/x", "w")'

  check "upload" curl --silent --show-error --fail --request PUT --json "$ARM" \
    --output /dev/null "$url/v1/robots/image_test_arm"
  local before
  before=$(get '/v1/robots/image_test_arm/fk?q=0.1,0.2')
  check "stops on SIGTERM, with status 0, within 10 s" stop_in_time
  engine rm "$NAME" >/dev/null
  start
  check "starts again, in a new container with the same volume" wait_until_live
  check "the uploaded robot is still there" test \
    "$(get '/v1/robots/image_test_arm/fk?q=0.1,0.2')" = "$before"

  local image base
  image=$(size_of "$IMAGE")
  base=$(size_of "$BASE")
  say "Size"
  printf 'image %d MiB, base %d MiB, difference %d MiB; %d bytes\n' \
    $((image >> 20)) $((base >> 20)) $(((image - base) >> 20)) $((image - base))
  print_split
  check "difference is below $LIMIT_MIB MiB" test $((image - base)) -lt $((LIMIT_MIB << 20))
  check "stops again" stop_in_time
}

if command -v docker >/dev/null && docker info >/dev/null 2>&1; then
  with_docker
else
  ((EUID == 0)) || { echo "no Docker engine answers, and building without one takes root" >&2; exit 1; }
  install_tools
  with_podman
fi
trap clean_up EXIT
say "Building"
begun=$SECONDS
build
echo "built in $((SECONDS - begun)) s"
say "Testing"
run_tests
say "All passed"

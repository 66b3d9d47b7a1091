"""Every command block of the README runs, in order, and prints what the README shows."""

import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path

import httpx

from app.settings import Settings
from tests.conftest import unused_port

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
VOLATILE = re.compile(r'(elapsed_ms"?: |request_id": ")[\w.-]+')


def blocks():
    """(language, text) in the order of the README."""
    return [(match[1], match[2]) for match in BLOCK.finditer(README)]


def shell(command, server, folder):
    """Runs a block as a reader would, against the test's server, in an empty folder."""
    text = command.replace("localhost:8000", server.removeprefix("http://"))
    text = text.replace("8010", str(unused_port()))
    environment = {**os.environ, "DENAVIT_DATA_DIR": str(folder / "data")}
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", text],
        cwd=folder, env=environment, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def normal(text):
    """Output without what differs from run to run, and with numbers to five digits."""
    text = VOLATILE.sub(r"\1…", text.strip())
    return re.sub(r"-?\d+\.\d+(?:e-?\d+)?", lambda m: f"{float(m[0]) + 0.0:z.5f}", text)


def test_commands_print_what_is_shown(server, tmp_path):
    (tmp_path / ".venv").symlink_to(ROOT / ".venv")
    found, ran = blocks(), 0
    for (language, text), (following, shown) in zip(found, [*found[1:], ("", "")], strict=True):
        if language != "bash" or text.startswith("make "):
            continue
        printed = shell(text, server, tmp_path)
        if following in ("text", "json"):
            expected = json.dumps(json.loads(shown)) if following == "json" else shown
            actual = json.dumps(json.loads(printed)) if following == "json" else printed
            assert normal(actual).split() == normal(expected).split()
        ran += 1
    assert ran >= 8
    assert (tmp_path / "pa10.urdf").stat().st_size > 1000
    for name in ("my-pa10", "my-arm"):
        assert httpx.delete(f"{server}/v1/robots/{name}").status_code == 204


def test_python_block(capsys):
    code = next(text for language, text in blocks() if language == "python")
    exec(compile(code, "README.md", "exec"), {})
    assert capsys.readouterr().out == "converged\n"


def test_make_run_serves_and_prints_a_command_that_works(tmp_path, free_port):
    port = free_port
    environment = {**os.environ, "DENAVIT_PORT": str(port), "DENAVIT_DATA_DIR": str(tmp_path)}
    process = subprocess.Popen(
        ["make", "run"], cwd=ROOT, env=environment, stderr=subprocess.PIPE, text=True,
        start_new_session=True,
    )  # fmt: skip
    try:
        command = ""
        while not command.strip().startswith("curl"):
            command = process.stderr.readline()
        deadline = time.monotonic() + 180
        while subprocess.run(["bash", "-c", command], capture_output=True, check=False).returncode:
            assert time.monotonic() < deadline
            time.sleep(0.1)
        printed = subprocess.run(
            ["bash", "-c", command], capture_output=True, text=True, check=True
        )
        assert "matrix:" in printed.stdout
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        process.communicate(timeout=20)


def test_every_other_block_is_run_elsewhere():
    """make test runs this; the image's commands are run by docker/image-test.sh."""
    others = [text for language, text in blocks() if language == "console"]
    assert all(line.startswith("docker ") for text in others for line in text.splitlines())
    makes = [text for language, text in blocks() if language == "bash" and text.startswith("make")]
    assert makes == ["make run\n"]


SETTING = re.compile(r"^\| `DENAVIT_(\w+)` \| (.*?) ?\| (.+) \|$", re.MULTILINE)
IN_WORDS = {"data_dir": "`~/.local/share/denavit`", "compute_threads": "number of cores"}


def shown(name):
    """The default of a setting as the table shows it."""
    if name in IN_WORDS:
        return IN_WORDS[name]
    default = Settings.model_fields[name].get_default(call_default_factory=True)
    if hasattr(default, "get_secret_value"):
        default = default.get_secret_value()
    if isinstance(default, bool):
        return f"`{default}`".lower()
    if isinstance(default, float):
        return f"`{default:g}`"
    return "" if default in ("", None) else f"`{default}`"


def test_the_table_of_settings_is_that_of_the_service():
    table = {name.lower(): default for name, default, _ in SETTING.findall(README)}
    assert table == {name: shown(name) for name in Settings.model_fields}
    assert len(SETTING.findall(README)) == len(table), "a setting stands twice"

"""Tables of the documentation that repeat what the code says are held to it."""

import re
import tomllib

from app.http.rendering import ALL_TYPES
from app.settings import Settings
from tests.docs.blocks import ROOT

SETTING = re.compile(r"^\| `DENAVIT_(\w+)` \| (.*?) ?\| (.+) \|$", re.MULTILINE)
PROBLEM = re.compile(r"^\| (\d{3}) \| `([\w-]+)` \| (.+) \|$", re.MULTILINE)
ENDPOINT = re.compile(r"`(GET|POST|PUT|DELETE) (/v1[\w/{}.-]*)`")
COMPUTATION = re.compile(r"`([\w/.-]+)`")
NAMED_VARIABLE = re.compile(r"\bDENAVIT_([A-Z_]*[A-Z])\b")
IN_WORDS = {
    "data_dir": "`~/.local/share/denavit`",
    "compute_threads": "number of cores",
    "max_worker_bytes": "what the container allows, or the machine has, divided by the workers",
}


def text_of(name):
    return (ROOT / name).read_text()


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
    found = SETTING.findall(text_of("docs/settings.md"))
    table = {name.lower(): default for name, default, _ in found}
    assert table == {name: shown(name) for name in Settings.model_fields}
    assert len(found) == len(table), "a setting stands twice"


def test_every_setting_that_is_named_exists():
    for path in (*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")):
        named = {name.lower() for name in NAMED_VARIABLE.findall(path.read_text())}
        assert named <= set(Settings.model_fields), path


def test_every_extra_that_is_named_exists():
    project = tomllib.loads(text_of("pyproject.toml"))["project"]
    table = text_of("docs/operate.md").partition("| extra | for |")[2].partition("\n\n")[0]
    named = set(re.findall(r"^\| `([\w-]+)`", table, re.MULTILINE))
    assert len(named) >= 5
    assert named <= set(project["optional-dependencies"])


def test_the_table_of_errors_is_that_of_the_service():
    found = PROBLEM.findall(text_of("docs/api.md"))
    assert {slug: (int(status), title) for status, slug, title in found} == {
        slug: (one.status, one.title) for slug, one in ALL_TYPES.items()
    }
    assert len(found) == len(ALL_TYPES)


def test_the_index_of_endpoints_is_that_of_the_service(client):
    index = text_of("docs/api.md").partition("## Index of endpoints")[2]
    listed = set(ENDPOINT.findall(index))
    rows = index.partition("| computation | |")[2].partition("\n\n")[0].splitlines()
    for row in rows:
        for name in COMPUTATION.findall(row.split("|")[1] if "|" in row else ""):
            on_robot = f"/v1/robots/{{id}}/{name}"
            listed |= {("GET", on_robot), ("POST", on_robot), ("POST", f"/v1/{name}")}
    served = {
        (method.upper(), path.replace("{robot_id}", "{id}"))
        for path, item in client.get("/openapi.json").json()["paths"].items()
        for method in item
        if path.startswith("/v1")
    }
    assert listed == served

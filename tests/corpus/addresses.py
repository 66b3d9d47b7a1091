"""Queries, ids, names, headers and methods."""

from __future__ import annotations

from collections.abc import Iterator

from tests.corpus.case import JSON, Case, body, line
from tests.corpus.tables import TABLE

FK = "/v1/robots/planar_2r/fk"
QUERIES: dict[str, tuple[str, tuple[str, ...]]] = {
    "nothing": ("", ("q",)),
    "empty q": ("q=", ("q",)),
    "no value": ("q", ("q",)),
    "trailing comma": ("q=0,", ("q",)),
    "three": ("q=0,0,0", ("2",)),
    "nan": ("q=nan,0", ("nan",)),
    "inf": ("q=-inf,0", ("inf",)),
    "1e400": ("q=1e400,0", ("1e400",)),
    "1e16": ("q=1e16,0", ("1e16",)),
    "hexadecimal": ("q=0x1p3,0", ("0x1p3",)),
    "underscore": ("q=1_0,0", ("1_0",)),
    "Arabic": ("q=%D9%A3,0", ("q",)),
    "wide": ("q=%EF%BC%91,0", ("q",)),
    "superscript": ("q=%C2%B2,0", ("q",)),
    "NUL": ("q=%00,0", ("q",)),
    "newline": ("q=0%0A,0%0D%0Ax", ("q",)),
    "direction": ("q=%E2%80%AE1,0", ("q",)),
    "no UTF-8": ("q=%ff,%fe", ("q",)),
    "bad percent": ("q=%zz,0", ("q",)),
    "lone percent": ("q=%,0", ("q",)),
    "code": ("q=__import__('os'),0", ("q",)),
    "tower": ("q=9**9**9,0", ("q",)),
    "brackets": ("q=" + "(" * 2000 + ",0", ("q",)),
    "division by zero": ("q=1/0,0", ("zero",)),
    "a variable": ("q=q1,0", ("q1",)),
    "plus for a blank": ("q=pi+1,0", ("%2B",)),
    "semicolons": ("q=0;0", ("q",)),
    "10,000 values": ("q=" + "0," * 10_000 + "0", ("q",)),
    "a length for an angle": ("q=10mm,0", ("length",)),
    "twice": ("q=0,0&q=1,1", ("twice",)),
    "twice by an escape": ("q=0,0&%71=1,1", ("twice",)),
    "unknown": ("q=0,0&qq=1", ("'qq'",)),
    "unknown of bad letters": ("q=0,0&a%0Ab%E2%80%AE=1", ("unknown",)),
    "misspelt": ("q=0,0&angel=deg", ("angle",)),
    "grad": ("q=0,0&angle=grad", ("grad",)),
    "empty angle": ("q=0,0&angle=", ("rad or deg",)),
    "unknown format": ("q=0,0&format=exe", ("exe",)),
    "unknown frame": ("q=0,0&frames=nil", ("nil",)),
    "empty frame": ("q=0,0&frames=tool,,x", ("frames",)),
    "unknown Euler": ("q=0,0&euler=ABC", ("ABC",)),
    "array in brackets": ("q[]=0&q[]=0", ("unknown",)),
    "SQL": ("q=0,0&id=1'%20OR%201=1--", ("unknown",)),
    "template": ("q={{7*7}},0", ("q",)),
    "log4j": ("q=${jndi:ldap://x},0", ("q",)),
}
IDS = {
    "a path": ("../../etc/passwd", (404, 405)),
    "an escaped path": ("..%2f..%2fetc%2fpasswd", (404, 405, 422)),
    "an escaped way up": ("%2e%2e", (404, 405, 422)),
    "a point": ("%2e", (404, 405, 422)),
    "hidden": (".hidden", (422,)),
    "NUL": ("a%00b", (422,)),
    "newline": ("a%0Ab", (422,)),
    "carriage return": ("a%0D%0ASet-Cookie:x=1", (422,)),
    "a blank": ("a%20b", (422,)),
    "a backslash": ("a%5Cb", (422,)),
    "a colon": ("c:d", (422,)),
    "a star": ("a*", (422,)),
    "a tilde": ("~root", (422,)),
    "a dash first": ("-rf", (422,)),
    "65 letters": ("a" * 65, (422,)),
    "4,000 letters": ("a" * 4000, (422, 414)),
    "10,000 letters": ("a" * 10_000, (414,)),
    "Cyrillic": ("%D1%81%D0%BE%D1%80", (422,)),
    "an emoji": ("%F0%9F%A4%96", (422,)),
    "direction": ("a%E2%80%AEb", (422,)),
    "no UTF-8": ("a%ff", (422,)),
    "a shipped robot": ("ur5", (409,)),
    "nothing": ("", (404, 405)),
    "a query in it": ("a%3Fb", (422,)),
    "a hash in it": ("a%23b", (422,)),
    "a semicolon": ("a;b=c", (422,)),
    "twice escaped": ("a%252e%252e", (422,)),
}
ADDRESSES = {
    "nowhere": "/v1/nothing",
    "slash at the end": "/v1/robots/",
    "slash at the end of a robot": "/v1/robots/ur5/",
    "two slashes": "/v1//robots",
    "another version": "/v2/robots",
    "dots": "/v1/../../../etc/passwd",
    "escaped dots": "/%2e%2e/%2e%2e/etc/passwd",
    "assets upwards": "/docs-assets/../../app/settings.py",
    "assets upwards, escaped": "/docs-assets/..%2f..%2fapp%2fsettings.py",
    "page upwards": "/assets/%2e%2e/%2e%2e/settings.py",
    "page absolute": "/assets//etc/passwd",
    "page NUL": "/assets/index.html%00.js",
    "meshes upwards": "/v1/robots/ur5/meshes/..%2f..%2f..%2fetc%2fpasswd",
    "meshes absolute": "/v1/robots/panda_urdf/meshes//etc/passwd",
    "unknown problem": "/problems/nothing",
    "problem upwards": "/problems/..%2fx",
    "a robot that is none": "/v1/robots/nothing/fk?q=0",
    "a robot in capitals": "/v1/robots/UR5/fk?q=0",
    "a robot with a blank": "/v1/robots/ur5%20/fk?q=0",
    "git": "/.git/config",
    "environment": "/.env",
    "php": "/index.php?s=/Index/",
    "server status": "/server-status",
    "admin": "/admin",
    "a line of a log": '/a%0D%0A{"level":"critical"}',
}
HEADERS: dict[str, tuple[tuple[tuple[str, str], ...], tuple[int, ...], tuple[str, ...]]] = {
    "no type": ((), (415,), ("--json",)),
    "an empty type": ((("Content-Type", ""),), (415,), ("--json",)),
    "HTML": ((("Content-Type", "text/html"),), (415,), ("text/html",)),
    "two types": (
        (("Content-Type", JSON), ("Content-Type", "application/x-npy")),
        (400,),
        ("twice",),
    ),
    "a type of 10,000 letters": ((("Content-Type", "x" * 10_000),), (415,), ("not read here",)),
    "a type with a newline": ((("Content-Type", "text/\u00ad\u0085x"),), (415,), ()),
    "charset latin-1": (
        (("Content-Type", "application/json; charset=latin-1"),),
        (415,),
        ("UTF-8",),
    ),
    "charset UTF-7": ((("Content-Type", "application/json; charset=utf-7"),), (415,), ("UTF-8",)),
    "accept of pictures": ((("Content-Type", JSON), ("Accept", "image/png")), (406,), ()),
    "accept of nothing": ((("Content-Type", JSON), ("Accept", "*/*;q=0")), (406,), ()),
    "if-match of another": ((("Content-Type", JSON), ("If-Match", '"abc"')), (200,), ()),
}
PUTS: dict[str, tuple[tuple[str, str], ...]] = {
    "another revision": (("If-Match", '"0123"'),),
    "any revision of none": (("If-Match", "*"),),
    "a weak tag": (("If-Match", 'W/"0123"'),),
    "a star in quotes": (("If-Match", '"*"'),),
    "a hundred tags": (("If-Match", ", ".join(f'"{k}"' for k in range(100))),),
}
METHODS = ("TRACE", "CONNECT", "PATCH", "PROPFIND", "MKCOL", "LOCK", "SEARCH", "PURGE", "COPY")


def refused() -> Iterator[Case]:
    """Addresses, headers and methods that lead nowhere."""
    for name, (query, words) in QUERIES.items():
        yield line(f"query: {name}", f"{FK}?{query}", 422, *words)
    yield line("query: of 40 kB", f"{FK}?{'x=1&' * 10_000}", 414, "POST")
    for size in ("0", "-1", "1001", "1e3", "", "%D9%A3", "9" * 500, "+1", "0x10", "1.5"):
        yield line(f"page size {size[:9]}", f"/v1/robots?page_size={size}", 422, "page_size")
    for name, (robot_id, status) in IDS.items():
        table = TABLE | {"name": None}
        del table["name"]
        yield body(f"id: {name}", f"/v1/robots/{robot_id}", table, status, method="PUT")
        yield line(f"id, read: {name}", f"/v1/robots/{robot_id}/urdf", (404, 414, 200))
        yield line(
            f"id, delete: {name}", f"/v1/robots/{robot_id}", (404, 405, 409, 414), method="DELETE"
        )
    for name, address in ADDRESSES.items():
        yield line(f"address: {name}", address, (404, 422))
    for name, (headers, statuses, words) in HEADERS.items():
        yield body(
            f"header: {name}", FK, b'{"q": [0, 0]}', statuses, *words, kind="", headers=headers
        )
    for name, headers in PUTS.items():
        table = {key: value for key, value in TABLE.items() if key != "name"}
        path = "/v1/robots/corpus-absent"
        yield body(f"condition: {name}", path, table, 412, method="PUT", headers=headers)
    for method in METHODS:
        yield line(f"method {method}", "/v1/robots/ur5", 405, method, "GET", method=method)


def accepted() -> Iterator[Case]:
    """Requests that must not be refused."""
    for name, query in {
        "expressions": "q=pi/2,-90deg",
        "brackets": "q=[0,0]",
        "blanks": "q=%200%20,%090",
        "signs": "q=%2B0.5,-.5",
        "exponents": "q=1e-3,1E2",
        "degrees": "q=90,0&angle=deg",
        "frames": "q=0,0&frames=tool,frame_1",
        "all frames": "q=0,0&frames=all&euler=zyx",
        "as text": "q=0,0&format=text",
    }.items():
        yield line(f"query, right: {name}", f"{FK}?{query}", 200)
    for name, headers in {
        "a browser's": (
            ("Accept", "text/html,application/xml;q=0.9,*/*;q=0.8"),
            ("Accept-Encoding", "gzip, br"),
            ("Cookie", 'a=b; c="d"'),
            ("Origin", "https://evil.example"),
            ("Sec-Fetch-Mode", "cors"),
        ),
        "an odd request id": (("X-Request-ID", "a b\tc"),),
        "forwarded": (("X-Forwarded-For", "1.2.3.4, 5.6.7.8"), ("Forwarded", "for=1.2.3.4")),
        "a method that overrides": (("X-HTTP-Method-Override", "DELETE"),),
        "ranges": (("Range", "bytes=0-1,2-3"),),
        "many accepts": (("Accept", "," * 3000 + "application/json"),),
        "an upgrade": (("Upgrade", "h2c"), ("HTTP2-Settings", "AAMAAABkAAQAAP__")),
    }.items():
        yield line(f"header, right: {name}", f"{FK}?q=0,0", 200, headers=headers)
    for path in (
        "/",
        "/health/live",
        "/health/ready",
        "/docs",
        "/v1/robots",
        "/v1/robots?page_size=1&page_token=%7F",
    ):
        yield line(f"right: {path}", path, 200)
        yield line(f"right: HEAD {path}", path, (200, 405), method="HEAD")

"""Names by which the service may be called."""

import http.client
from contextlib import closing

import pytest

from app.access.hosts import LOOPBACK, InvalidHosts, allowed_hosts, named_by_address
from app.settings import Settings
from tests.app.access.requests import FK
from tests.conftest import PATIENCE


def asked(server, *hosts, path=FK, version=11):
    """Status and body of a request with these Host headers."""
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=PATIENCE)
    connection._http_vsn = version
    connection._http_vsn_str = "HTTP/1.1" if version == 11 else "HTTP/1.0"
    with closing(connection):
        connection.putrequest("GET", path, skip_host=True)
        for host in hosts:
            connection.putheader("Host", host)
        connection.putheader("Connection", "close")
        connection.endheaders()
        with connection.getresponse() as answer:
            return answer.status, answer.read().decode()


def test_a_server_of_this_machine_goes_by_its_names_only(serve):
    with serve(allowed_hosts="") as server:
        for host in ("localhost", f"localhost:{server.port}", "127.0.0.1", "[::1]:8000"):
            assert asked(server, host)[0] == 200, host
        for host in ("LOCALHOST", "localhost."):
            assert asked(server, host)[0] == 200, host
        for host in ("rebound.example", "localhost.evil.example", "127.0.0.1.evil.example"):
            status, body = asked(server, host)
            assert status == 421, host
            assert host in body
            assert "DENAVIT_ALLOWED_HOSTS" in body
        for path in ("/health/live", "/health/ready"):
            for host in ("10.1.2.3:8000", "[fd00::1]:8000"):
                assert asked(server, host, path=path)[0] == 200, (host, path)
            # A name may have been given this address; readiness names damaged robots.
            for host in ("rebound.example", "10.1.2.3.rebound.example"):
                assert asked(server, host, path=path)[0] == 421, (host, path)


def test_a_request_says_once_whom_it_calls(serve):
    with serve() as server:
        wrong = ((), ("a", "b"), ("a", "a"), ("",), ("a b",), ("a/b",), ("a@b",), ('"<i>"',))
        for hosts in (*wrong, ("a:port",), ("a:1:2",), ("::1",)):
            assert asked(server, *hosts)[0] == 400, hosts
        assert asked(server, version=10)[0] == 200
        assert asked(server, "a", "b", version=10)[0] == 400


def test_names_are_those_that_are_chosen(serve):
    with serve(allowed_hosts="robots.example.org, *.lab.example") as server:
        for host in ("robots.example.org:443", "a.lab.example", "b.a.lab.example"):
            assert asked(server, host)[0] == 200, host
        for host in ("lab.example", "evil-lab.example", "localhost"):
            assert asked(server, host)[0] == 421, host


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.1.1", "::1", "localhost"])
def test_the_loopback_interface_has_names(host):
    assert allowed_hosts(named_by_address(Settings(host=host))) == LOOPBACK


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1", "robots"])
def test_other_addresses_have_any(host):
    assert allowed_hosts(named_by_address(Settings(host=host))) == ("*",)


@pytest.mark.parametrize("text", ["http://a", "a:80", "a/b", "*a", "a.*"])
def test_what_is_no_name_is_told(text):
    with pytest.raises(InvalidHosts, match="DENAVIT_ALLOWED_HOSTS"):
        allowed_hosts(Settings(allowed_hosts=text))

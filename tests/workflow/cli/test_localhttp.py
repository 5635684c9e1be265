"""What attacks a server of this machine costs it: one line each, and no traceback."""

import http.client
import ipaddress
import json
import math
import socket
import struct
import threading
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import pytest

from surrogate import FactorialRegressor
from tests.patience import PATIENCE
from workflow.cli import localhttp, serving

JSON = {"Content-Type": "application/json"}
ASKED = b'{"name": "surrogate", "input": [[0.5]]}'


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    """A server in this process: y = 1e9 x on [0, 1]."""
    model = FactorialRegressor().fit([[0.0], [0.5], [1.0]], [0.0, 0.5e9, 1e9]).model_
    answer = partial(serving.answer, {"surrogate": serving.Model(model)})
    with localhttp.server(answer, "127.0.0.1", 0) as bound:
        threading.Thread(target=bound.serve_forever, daemon=True).start()
        yield bound.server_address[1]
        bound.shutdown()


def told(port: int, path: str, body: bytes | None, headers: Mapping[str, str]) -> tuple[int, Any]:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
    connection.request("GET" if body is None else "POST", path, body, dict(headers))
    answer = connection.getresponse()
    found = answer.status, json.loads(answer.read(), parse_constant=pytest.fail)
    connection.close()
    return found


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        (JSON, 200),
        (JSON | {"Host": "localhost:4242"}, 200),
        (JSON | {"Host": "[::1]:4242"}, 200),
        (JSON | {"Origin": "http://localhost:8888"}, 200),
        (JSON | {"Content-Type": "application/json; charset=utf-8"}, 200),
        (JSON | {"Host": "attacker.example:4242"}, 403),
        (JSON | {"Host": "localhost.attacker.example"}, 403),
        (JSON | {"Host": "[attacker"}, 403),
        (JSON | {"Host": ""}, 403),
        (JSON | {"Origin": "https://attacker.example"}, 403),
        (JSON | {"Origin": "null"}, 403),
        ({"Content-Type": "text/plain"}, 415),
        ({}, 415),
        (JSON | {"Content-Length": "9" * 5000}, 413),
        (JSON | {"Content-Length": "-1"}, 413),
        (JSON | {"Content-Length": "2097152"}, 413),
    ],
)
def test_only_programs_of_this_machine_are_answered(port: int, headers: Mapping[str, str], status: int) -> None:
    found, answer = told(port, "/Evaluate", ASKED, headers)
    assert found == status
    assert ("error" in answer) == (status != 200)


def test_a_page_of_another_site_may_not_even_ask_what_is_served(port: int) -> None:
    assert told(port, "/Info", None, {})[0] == 200
    assert told(port, "/Info", None, {"Origin": "https://attacker.example"})[0] == 403


@pytest.mark.parametrize(
    ("host", "name", "allowed"),
    [
        ("127.0.0.1", "10.0.0.7", False),
        ("lab.example", "Lab.Example:4242", True),
        ("lab.example", "other.example", False),
        (str(ipaddress.IPv4Address(0)), "10.0.0.7:4242", True),
        (str(ipaddress.IPv4Address(0)), "attacker.example", False),
    ],
)
def test_the_option_host_names_others(host: str, name: str, allowed: bool) -> None:
    assert localhttp.Names(host).allow(name) is allowed


@pytest.mark.parametrize(
    ("path", "body", "reason"),
    [
        ("/Evaluate", b'{"name": "surrogate", "input": [[%s]]}' % (b"9" * 400), "input: must be 1 finite numbers"),
        ("/Evaluate", b'{"name": "surrogate", "input": [[%s]]}' % (b"9" * 5000), "input: must be 1 finite numbers"),
        ("/Evaluate", b'{"name": "surrogate", "input": [[true]]}', "input: must be 1 finite numbers"),
        (
            "/Gradient",
            b'{"name": "surrogate", "input": [[0.5]], "sens": [1e308]}',
            "the answer is beyond the largest number",
        ),
        (
            "/ApplyJacobian",
            b'{"name": "surrogate", "input": [[0.5]], "vec": [-1e308]}',
            "the answer is beyond the largest number",
        ),
    ],
)
def test_numbers_without_a_meaning_are_refused_in_valid_json(port: int, path: str, body: bytes, reason: str) -> None:
    status, answer = told(port, path, body, JSON)
    assert (status, answer["error"]["message"]) == (400, reason)


def test_clients_that_leave_cost_no_word(port: int, capfd: pytest.CaptureFixture[str]) -> None:
    head = b"POST /Evaluate HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n"
    for number in range(100):
        with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE) as client:
            client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # leaves by a reset
            client.sendall(head % len(ASKED) + ASKED[: len(ASKED) // (1 + number % 2)])
    status, answer = told(port, "/Evaluate", ASKED, JSON)
    assert status == 200
    assert math.isclose(answer["output"][0][0], 0.5e9, rel_tol=1e-6)
    assert "Traceback" not in capfd.readouterr().err

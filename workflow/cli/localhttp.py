"""Answers JSON over HTTP to programs of this machine, and to no page that a browser shows.

A browser sends Origin, and Host as its page names the server; a page of another site, or one whose name is made to mean
this machine, has other names than the server's own and is refused. One request is answered at a time.
"""

import ipaddress
import json
import re
import socket
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Lock
from typing import Any
from urllib.parse import urlsplit

_LONGEST = 2**20  # bytes of a request
_LOOPBACK = frozenset({"localhost", "127.0.0.1", "::1"})
_EVERYWHERE = frozenset({"", str(ipaddress.IPv4Address(0)), str(ipaddress.IPv6Address(0))})

Answer = Callable[[str, Mapping[str, Any]], Mapping[str, Any]]


@dataclass(frozen=True)
class Names:
    """The names under which a server may be addressed: no page of another site can make a browser use them."""

    host: str  # What the server is bound to

    def allow(self, netloc: str) -> bool:
        """Whether `name` or `name:port` is one of them."""
        try:
            name = urlsplit(f"//{netloc}").hostname or ""
        except ValueError:
            return False
        return name in _LOOPBACK | {self.host.lower()} or (self._everywhere and _is_of_a_machine(name))

    @property
    def _everywhere(self) -> bool:
        return self.host in _EVERYWHERE


def _is_of_a_machine(name: str) -> bool:
    """Whether it is this machine's name or a number, which no foreign name server can give a new meaning."""
    try:
        return bool(ipaddress.ip_address(name))
    except ValueError:
        return name == socket.gethostname().lower()


class Server(ThreadingHTTPServer):
    """Says nothing of clients that leave before they are answered."""

    request_queue_size = 128  # of clients that connect at once

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say what went wrong here, and nothing of a broken connection."""
        if not isinstance(sys.exc_info()[1], ConnectionError | TimeoutError):
            super().handle_error(request, client_address)


def _read(text: bytes) -> Mapping[str, Any] | None:
    """A JSON object, or None; its numbers are floats: one of more digits than fit is infinite."""
    try:
        body = json.loads(text, parse_int=float)
    except (ValueError, RecursionError):
        return None
    return body if isinstance(body, dict) else None


def server(answer: Answer, host: str, port: int) -> Server:
    """A server that is bound to its address and answers once `serve_forever` is called."""
    one_at_a_time, names = Lock(), Names(host)

    class Handler(BaseHTTPRequestHandler):
        """Answers in JSON, and no page of another site."""

        timeout = 60

        def do_GET(self) -> None:
            if self._is_for_us():
                self._answer({})

        def do_POST(self) -> None:
            length = self.headers.get("Content-Length", "")
            if not self._is_for_us():
                return
            if self.headers.get_content_type() != "application/json":
                self._send(415, _invalid("Content-Type: must be application/json"))
            elif not re.fullmatch("[0-9]{1,7}", length) or int(length) > _LONGEST:
                self._send(413, _invalid(f"Content-Length: must be said, and at most {_LONGEST}"))
            else:
                self._read_and_answer(int(length))

        def _is_for_us(self) -> bool:
            """Whether Host, and Origin where a browser sends one, are names of this server; else it is refused."""
            scheme, _, origin = self.headers.get("Origin", f"http://{host}").partition("://")
            for header, allowed in (
                ("Host", names.allow(self.headers.get("Host", ""))),
                ("Origin", scheme in ("http", "https") and names.allow(origin)),
            ):
                if not allowed:
                    self._send(403, _invalid(f"{header}: not a name of this server (option --host)"))
                    return False
            return True

        def _read_and_answer(self, length: int) -> None:
            body = _read(self.rfile.read(length))
            if body is None:
                self._send(400, _invalid("the request must be a JSON object"))
            else:
                self._answer(body)

        def _answer(self, body: Mapping[str, Any]) -> None:
            with one_at_a_time:
                content = answer(self.path, body)
            self._send(400 if "error" in content else 200, content)

        def _send(self, status: int, content: Mapping[str, Any]) -> None:
            text = json.dumps(content, allow_nan=False).encode()
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(text)))
            self.end_headers()
            self.wfile.write(text)

        def log_message(self, *_: Any) -> None:
            """Quiet."""

    return Server((host, port), Handler)


def _invalid(message: str) -> dict[str, Any]:
    return {"error": {"type": "InvalidInput", "message": message}}

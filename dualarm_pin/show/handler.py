"""What the local server does with a request: who may ask, and how much.

Any web site can send requests to a loopback address from the user's own browser. So a request must
name this address as its host; what asks for work must also come from our page (Origin), carry the
token that only our page holds, and say that it is JSON: another site cannot send such a request
without asking first, and is not answered then.
"""

from __future__ import annotations

import hmac
import json
import secrets
from collections.abc import Callable
from dataclasses import dataclass, field
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler

from dualarm_pin.errors import DualArmError

LOOPBACK = "127.0.0.1"
TOKEN = "X-Token"
LARGEST = 100_000  # bytes of a request: a thousand joint limits
_PATIENCE = 60.0  # s without a word, after which a connection is closed

Page = bytes | Callable[[], bytes]


@dataclass(frozen=True)
class Talk:
    """What answers a page that asks.

    Attributes:
        answers: By path, such as `/move`: takes the body (JSON) and returns bytes. What it refuses
            it raises as `DualArmError`, and the page is told.
        token: What the page sends with each request; a new one for each program.
    """

    answers: dict[str, Callable[[bytes], bytes]]
    token: str = field(default_factory=secrets.token_urlsafe)


def handler(page: Page, talk: Talk | None) -> type[BaseHTTPRequestHandler]:
    """Return the handler that serves a page and, if there is anything to ask, its questions."""

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"  # connections stay open
        disable_nagle_algorithm = True  # with it every answer would wait 40 ms
        wbufsize = -1
        timeout = _PATIENCE

        def do_GET(self) -> None:
            if not self._addressed_here():
                self.send_error(HTTPStatus.FORBIDDEN, "not served under this name")
            elif self.path.split("?")[0] != "/":
                self.send_error(HTTPStatus.NOT_FOUND)
            else:
                made = page if isinstance(page, bytes) else page()
                self._send(HTTPStatus.OK, "text/html; charset=utf-8", made)

        def do_POST(self) -> None:
            refused = self._refused()
            if refused:  # the body is not read: the connection ends
                self.send_error(*refused)
                return
            assert talk is not None  # else it is refused
            body = self.rfile.read(int(self.headers["Content-Length"]))
            try:
                self._send(HTTPStatus.OK, "application/octet-stream", talk.answers[self.path](body))
            except DualArmError as error:
                said = json.dumps({"error": str(error)}).encode()
                self._send(HTTPStatus.BAD_REQUEST, "application/json", said)

        def _refused(self) -> tuple[HTTPStatus, str] | None:
            length = self.headers.get("Content-Length", "")
            token = self.headers.get(TOKEN, "").encode()
            if not self._addressed_here():
                return HTTPStatus.FORBIDDEN, "not served under this name"
            if talk is None or self.path not in talk.answers:
                return HTTPStatus.NOT_FOUND, "nothing answers here"
            if self.headers.get("Origin") != f"http://{self.headers['Host']}":
                return HTTPStatus.FORBIDDEN, "asked from another page"
            if not hmac.compare_digest(token, talk.token.encode()):
                return HTTPStatus.FORBIDDEN, "the token is wrong"
            if self.headers.get_content_type() != "application/json":
                return HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "JSON is expected"
            if not (length.isascii() and length.isdigit()) or "Transfer-Encoding" in self.headers:
                return HTTPStatus.LENGTH_REQUIRED, "Content-Length is expected"
            if len(length) > len(str(LARGEST)) or int(length) > LARGEST:
                return HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"{LARGEST} bytes at most"
            return None

        def _addressed_here(self) -> bool:
            # A web site that points its own name at this address must not read the page.
            host = self.headers.get("Host", "").rsplit(":", 1)[0]
            return host in (LOOPBACK, "localhost")

        def _send(self, status: HTTPStatus, kind: str, data: bytes) -> None:
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(data)))
            self.send_header("Cache-Control", "no-store")
            self.send_header("X-Content-Type-Options", "nosniff")
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, format: str, *args: object) -> None:
            """Stay silent: the terminal belongs to the command."""

    return Handler

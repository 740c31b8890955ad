"""Access to the desk: host names that it answers to, its token, and the origin of changes.

- *Host*: a request for another host name is answered 421, so that no foreign page can reach the desk through a name
  that it points here (DNS rebinding).
- *Token*: where one is set, requests without it are answered 401. `?token=` becomes a cookie at the first visit and is
  removed from the address; the comparison takes constant time.
- *Changes*: a POST must come from the desk's own pages (Origin, Sec-Fetch-Site) and carry a token that belongs to the
  visitor's same-site cookie, so that links and forms of other sites change nothing (CSRF).
- *Pages*: a Content-Security-Policy without inline code; no framing by others, no referrer.

One ASGI layer around the application.
"""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
import secrets
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from urllib.parse import urlencode, urlsplit

from starlette.datastructures import MutableHeaders
from starlette.requests import Request
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "frame-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
)
HEADERS: Mapping[str, str] = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
"""Headers of every answer that does not set them itself."""
VISITOR, PASS = "sgcad_desk", "sgcad_desk_pass"
CSRF_HEADER = "x-desk-token"
LOOPBACK = ("localhost", "127.0.0.1", "::1")
BODY_LIMIT = 1_000_000
"""Bytes of a request's body; an edit has a few hundred."""


@dataclass(frozen=True)
class Gate:
    """Conditions of access. `names`: host names that the desk answers to; `token`: "" where none is needed."""

    names: frozenset[str] = frozenset(LOOPBACK)
    token: str = ""
    any_address: bool = False
    """Whether any IP address is a name of the desk too, as where it listens on all of a machine's: a page elsewhere
    cannot point an address at another machine."""
    secret: bytes = field(default_factory=lambda: secrets.token_bytes(32), repr=False)

    def is_own(self, host: str) -> bool:
        """Whether a Host header names the desk."""
        name = urlsplit(f"//{host}").hostname or ""
        return name in self.names or (self.any_address and _is_address(name))

    def csrf_of(self, visitor: str) -> str:
        """The token that a visitor's changes must carry."""
        return hmac.new(self.secret, visitor.encode(), hashlib.sha256).hexdigest()

    def admits(self, given: str) -> bool:
        """Whether this is the token."""
        return not self.token or hmac.compare_digest(given.encode(), self.token.encode())


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


class Guard:
    """The ASGI layer. Puts `csrf` and the visitor's cookie into the request's state."""

    def __init__(self, app: ASGIApp, gate: Gate) -> None:
        self.app = app
        self.gate = gate

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or hand on to the application."""
        if scope["type"] != "http":
            await (self.app(scope, receive, send) if scope["type"] == "lifespan" else _close(send))
            return
        request = Request(scope)
        refusal = self._refusal(request)
        visitor = request.cookies.get(VISITOR, "")
        fresh = not (40 <= len(visitor) <= 80 and visitor.isascii())
        visitor = secrets.token_urlsafe(32) if fresh else visitor
        scope.setdefault("state", {})["csrf"] = self.gate.csrf_of(visitor)
        answer: ASGIApp = refusal or self.app
        await answer(scope, receive, _with_headers(send, visitor if fresh and not refusal else ""))

    def _refusal(self, request: Request) -> Response | None:
        host = request.headers.get("host", "")
        if not self._named(host):
            known = ", ".join(sorted(self.gate.names))
            return PlainTextResponse(
                f"This is not an address of this desk. It answers to: {known} (--name adds one).", 421
            )
        if not self.gate.admits(request.cookies.get(PASS, "")):
            return self._first_visit(request)
        if request.method not in ("GET", "HEAD"):
            return self._change(request, host)
        return None

    def _named(self, host: str) -> bool:
        try:
            return self.gate.is_own(host)
        except ValueError:
            return False

    def _first_visit(self, request: Request) -> Response:
        """Turn the token in the address into a cookie; answer 401 without it."""
        if request.method == "GET" and self.gate.admits(request.query_params.get("token", "")):
            rest = urlencode([(k, v) for k, v in request.query_params.multi_items() if k != "token"])
            answer = RedirectResponse(_local(request.url.path) + (f"?{rest}" if rest else ""), 303)
            answer.set_cookie(PASS, self.gate.token, httponly=True, samesite="lax", path="/")
            return answer
        return PlainTextResponse("Open the address with ?token=... that `sgcad desk` printed when it started.", 401)

    def _change(self, request: Request, host: str) -> Response | None:
        """None for a change that a page of the desk requests, else the refusal."""
        origin = request.headers.get("origin")
        site = request.headers.get("sec-fetch-site", "same-origin")
        foreign = site not in ("same-origin", "none") or (origin is not None and urlsplit(origin).netloc != host)
        given = request.headers.get(CSRF_HEADER, "")
        known = self.gate.csrf_of(request.cookies.get(VISITOR, ""))
        if foreign or not request.cookies.get(VISITOR) or not hmac.compare_digest(given.encode(), known.encode()):
            return PlainTextResponse("This change does not come from a page of this desk. Reload the page.", 403)
        length = request.headers.get("content-length", "")
        if not (length.isascii() and length.isdigit()):
            return PlainTextResponse("A change needs the header Content-Length.", 411)
        if int(length) > BODY_LIMIT:
            return PlainTextResponse(f"{length} bytes are too many for an edit; the limit is {BODY_LIMIT}.", 413)
        return None


def _local(path: str) -> str:
    """A path that cannot be taken for another host's address."""
    return "/" + path.lstrip("/\\")


def _with_headers(send: Send, visitor: str) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in HEADERS.items():
                headers.setdefault(name, value)
            if visitor:
                headers.append("set-cookie", f"{VISITOR}={visitor}; HttpOnly; Path=/; SameSite=Lax")
        await send(message)

    return sending


async def _close(send: Callable[[Message], Awaitable[None]]) -> None:
    """Refuse a web socket."""
    await send({"type": "websocket.close", "code": 1008})

"""A headless Chromium that walks the desk as a person does: mouse, keys, what is on the screen, what goes wrong."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from contextlib import contextmanager
from typing import Any

from research.checks.mlflow_pages import Browser, browsing

WAIT_S = 60.0
POOR = """
const linear = v => v <= .03928 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4;
const lum = c => { const [r, g, b] = c.map(v => linear(v / 255));
  return .2126 * r + .7152 * g + .0722 * b; };
const parts = c => (c.match(/[\\d.]+/g) || []).map(Number);
const ground = e => { for (; e; e = e.parentElement) { const c = parts(getComputedStyle(e).backgroundColor);
  if (c.length === 3 || c[3] > .99) return c.slice(0, 3); } return [255, 255, 255]; };
const poor = [], WRITTEN = 'input:not([type=file], [type=range], [type=checkbox]), select';
for (const e of document.querySelectorAll('body *')) {
  if (e.closest('svg, iframe, [hidden]') || !e.getClientRects().length) continue;
  if (![...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim()) && !e.matches(WRITTEN)) continue;
  const s = getComputedStyle(e), size = parseFloat(s.fontSize);
  const large = size >= 24 || (size >= 18.7 && Number(s.fontWeight) >= 700);
  const [a, b] = [lum(parts(s.color)), lum(ground(e))].sort((x, y) => y - x), ratio = (a + .05) / (b + .05);
  if (ratio < (large ? 3 : 4.5) && s.opacity !== '0')
    poor.push(`${ratio.toFixed(2)} ${e.tagName}.${e.className}: ${e.textContent.slice(0, 40)}`);
}
"""
"""Collects what is written with too little contrast, WCAG 2.1, 1.4.3: 4.5, 3 for large letters."""
KEYS = {"Enter": 13, "Escape": 27, "Tab": 9, "ArrowLeft": 37, "ArrowRight": 39, " ": 32}


class Walker:
    """A tab with a person's hands. `faults`: errors that the console or the page told of since the beginning."""

    def __init__(self, browser: Browser) -> None:
        self.browser = browser
        self.faults: list[str] = []
        for domain in ("Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method: str, session: str = "", **params: Any) -> dict[str, Any]:
        """A DevTools command, of a `session` for a frame of another origin; what the console says meanwhile is kept."""
        browser = self.browser
        browser.number += 1
        order = {"id": browser.number, "method": method, "params": params} | ({"sessionId": session} if session else {})
        browser.connection.send(json.dumps(order))
        while True:
            said = json.loads(browser.connection.recv(timeout=WAIT_S))
            self._heard(said)
            if said.get("id") == browser.number:
                assert "error" not in said, said["error"]
                return said.get("result", {})

    def _heard(self, said: dict[str, Any]) -> None:
        kind, told = said.get("method"), said.get("params", {})
        if kind == "Runtime.exceptionThrown":
            details = told["exceptionDetails"]
            self.faults.append(details.get("exception", {}).get("description") or details["text"])
        elif kind == "Log.entryAdded" and told["entry"]["level"] == "error":
            self.faults.append(f"{told['entry']['text']} {told['entry'].get('url', '')}")
        elif kind == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning"):
            self.faults.append(str(told["args"]))

    def run(self, script: str) -> Any:
        """The value of an expression on the page."""
        said = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in said, said["exceptionDetails"]
        return said["result"].get("value")

    def inside(self, kind: str = "iframe") -> Callable[[str], Any]:
        """What runs scripts inside the page's frame, which has a process and an origin of its own."""
        deadline = time.monotonic() + WAIT_S
        while not (targets := [t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == kind]):
            assert time.monotonic() < deadline, "there is no frame"
            time.sleep(0.1)
        session = self.call("Target.attachToTarget", targetId=targets[-1]["targetId"], flatten=True)["sessionId"]

        def run(script: str) -> Any:
            said = self.call("Runtime.evaluate", session, expression=script, returnByValue=True)
            assert "exceptionDetails" not in said, said
            return said["result"].get("value")

        return run

    def size(self, width: int, height: int, mobile: bool = False) -> None:
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=mobile)

    def theme(self, name: str) -> None:
        """What the person prefers: light or dark."""
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}])

    def poor(self) -> list[str]:
        """What is written on the page with too little contrast to be read."""
        return list(self.run(f"(() => {{ {POOR}; return poor; }})()"))

    def open(self, url: str) -> None:
        self.run("window.walkedBefore = true")
        self.call("Page.navigate", url=url)
        self.until("!window.walkedBefore && document.readyState === 'complete'")

    def until(self, script: str, wait_s: float = WAIT_S) -> None:
        """Wait until an expression holds."""
        deadline = time.monotonic() + wait_s
        while True:
            try:
                if self.run(f"document.readyState === 'complete' && Boolean({script})"):
                    return
            except AssertionError:  # a page that is just changing has no document
                pass
            if time.monotonic() > deadline:
                here = self.run("location.href + '\\n' + document.body.innerText.slice(0, 600)")
                raise AssertionError(f"never so: {script}; faults: {self.faults}; the page: {here}")
            time.sleep(0.05)

    def place(self, selector: str) -> tuple[float, float]:
        """The middle of an element on the screen, scrolled to, once the page is drawn and nothing moves it any more."""
        self.call(
            "Runtime.evaluate",
            awaitPromise=True,
            expression=(
                "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50))))"
            ),
        )
        at = self.run(
            f"(() => {{ const n = document.querySelector({json.dumps(selector)});"
            " n.scrollIntoView({block: 'center'});"
            " const r = n.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()"
        )
        return at[0], at[1]

    def mouse(self, kind: str, x: float, y: float, buttons: int = 0) -> None:
        button = "left" if buttons or kind != "mouseMoved" else "none"
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, buttons=buttons, clickCount=1)

    def click(self, selector: str) -> None:
        x, y = self.place(selector)
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y, 1)
        self.mouse("mouseReleased", x, y)

    def drag(self, selector: str, to: str) -> None:
        """From one element's middle to another's, in steps."""
        x, y = self.place(selector)
        u, v = self.run(
            f"(() => {{ const r = document.querySelector({json.dumps(to)}).getBoundingClientRect();"
            " return [r.x + r.width / 2, r.y + r.height / 2]; })()"
        )
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y, 1)
        for k in range(1, 9):
            self.mouse("mouseMoved", x + (u - x) * k / 8, y + (v - y) * k / 8, 1)
        self.mouse("mouseReleased", u, v)

    def key(self, name: str) -> None:
        text = {"Enter": "\r", "Tab": ""}.get(name, name if len(name) == 1 else "")
        code = KEYS.get(name, ord(name[0].upper()))
        more = {"text": text} if text else {}
        self.call("Input.dispatchKeyEvent", type="keyDown", key=name, windowsVirtualKeyCode=code, **more)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=name, windowsVirtualKeyCode=code)

    def type(self, text: str) -> None:
        self.call("Input.insertText", text=text)

    def tab_to(self, condition: str, most: int = 120) -> None:
        """Tab until the focused element (`e`) is as wanted; every stop on the way must show its focus."""
        for _ in range(most):
            self.key("Tab")
            if self.run(f"(e => Boolean({condition}))(document.activeElement)"):
                return
        raise AssertionError(f"{most} tabs reach nothing where {condition}")

    def text(self) -> str:
        return str(self.run("document.body.innerText"))


@contextmanager
def walking(program: str):
    """A fresh browser."""
    with browsing(program) as browser:
        yield Walker(browser)

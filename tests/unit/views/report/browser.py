"""Headless Chromium, asked through the pipe of its DevTools protocol: one page from a file, without a network."""

from __future__ import annotations

import json
import os
import select
import shutil
import subprocess
from base64 import b64decode
from io import BytesIO
from pathlib import Path
from time import monotonic

from matplotlib.image import imread

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
_FLAGS = (
    "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--remote-debugging-pipe", "--hide-scrollbars",
)  # fmt: skip
_PATIENCE = 60.0
"""s, for one answer on a busy machine."""
_ADDRESS_SPACE = "DISPLAY", "DBUS_SESSION_BUS_ADDRESS"


class Browser:
    """A browser of its own with one page; `told` are messages of its console, failures and requests for anything."""

    def __init__(self, folder: Path, *more: str) -> None:
        ours, theirs = os.pipe(), os.pipe()
        command = [CHROMIUM, *_FLAGS, *more, f"--user-data-dir={folder}", "about:blank"]
        environment = {key: value for key, value in os.environ.items() if key not in _ADDRESS_SPACE}
        # the browser reads commands from its descriptor 3 and writes answers to 4
        script = f'exec 3<&{ours[0]} 4>&{theirs[1]}; exec "$@"'
        self._process = subprocess.Popen(
            ["bash", "-c", script, "bash", *command],
            pass_fds=(ours[0], theirs[1]), env=environment,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(ours[0])
        os.close(theirs[1])
        self._out, self._in = ours[1], theirs[0]
        self._rest, self._number, self._session = b"", 0, None
        self.told: list[str] = []
        self.events: list[str] = []
        (page,) = [one for one in self.ask("Target.getTargets")["targetInfos"] if one["type"] == "page"]
        self._session = self.ask("Target.attachToTarget", targetId=page["targetId"], flatten=True)[
            "sessionId"
        ]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")

    def close(self) -> None:
        """End it."""
        os.close(self._out)
        os.close(self._in)
        self._process.terminate()
        self._process.wait(_PATIENCE)

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def ask(self, method: str, **parameters):
        """The answer to a command."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._number:
                assert "error" not in answer, answer["error"]
                return answer["result"]

    def open(self, path: Path, width: int = 420, height: int = 320) -> None:
        """Load a page and wait until it is there; small, as a processor draws every pixel."""
        self.ask(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        self.events.clear()
        self.ask("Page.navigate", url=path.resolve().as_uri())
        while "Page.loadEventFired" not in self.events:
            self._next()

    def run(self, script: str):
        """The value of an expression, of a promise when it is kept."""
        found = self.ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def picture(self, identity: str = ""):
        """What the window holds of an element, or of anything: (height, width, 3) from 0 to 1."""
        return imread(BytesIO(self.png(identity)))[..., :3]

    def png(self, identity: str = "") -> bytes:
        """The same as a file."""
        clip = {}
        if identity:
            box = self.run(f"""(() => {{
                const element = document.getElementById({json.dumps(identity)});
                element.scrollIntoView({{behavior: "instant"}});
                const box = element.getBoundingClientRect();
                const height = Math.min(box.height, innerHeight - box.y);
                return {{x: box.x + scrollX, y: box.y + scrollY, width: box.width, height, scale: 1}};
            }})()""")
            clip = {"clip": box}
        return b64decode(self.ask("Page.captureScreenshot", format="png", **clip)["data"])

    def _next(self):
        """The next message; what the page says is kept."""
        end = monotonic() + _PATIENCE
        while b"\0" not in self._rest:
            ready, _, _ = select.select([self._in], [], [], max(end - monotonic(), 0.0))
            assert ready, "the browser does not answer"
            part = os.read(self._in, 1 << 20)
            assert part, "the browser has ended"
            self._rest += part
        text, _, self._rest = self._rest.partition(b"\0")
        message = json.loads(text)
        method, content = message.get("method", ""), message.get("params", {})
        self.events.append(method)
        if method in ("Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"):
            self.told.append(json.dumps(content))
        if method == "Network.requestWillBeSent" and content["request"]["url"].partition(":")[0] not in (
            "data",
            "file",
            "blob",
        ):
            self.told.append(content["request"]["url"])
        return message

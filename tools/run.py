"""What ``make run`` does: serve, show one answer, and go on serving until Ctrl-C.

1. refuse a taken port before anything slow happens;
2. start the service exactly as in production, and show how its kernels are loaded or compiled;
3. POST the example, print what came back, write its picture;
4. wait.
"""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from http.client import HTTPException
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

ROOT = Path(__file__).resolve().parents[1]
EXAMPLE = ROOT / "openapi" / "examples" / "ampersand.json"
PICTURE = ROOT / "out" / "example.svg"
HOST = "127.0.0.1"
START_SECONDS = 180
"""Longest wait for the kernels: compiling takes some 30 s on a slow core."""

Json = dict[str, Any]


def main() -> int:
    """Run the steps; the exit code is 0 after Ctrl-C, 1 after a failure, 2 for a port that cannot be used."""
    port = read_port(os.environ.get("PORT", "8000"))
    if port is None:
        return 2
    base = f"http://{HOST}:{port}"
    signal.signal(signal.SIGTERM, interrupt)
    server = start(port)
    try:
        wait_until_ready(server, base)
        show_example(base)
        print(
            f"\nServing on {base} until Ctrl-C. Next:\n"
            f"  the documentation, to read and try:  {base}/docs\n"
            f"  a domain of your own:  curl -H 'Content-Type: application/json' -d @domain.json {base}/v1/mat\n"
            f"  the shapes to begin with:  {EXAMPLE.parent.relative_to(ROOT)}/"
        )
        server.wait()
        print(f"The service ended by itself with exit code {server.returncode}.")
        return 1
    except KeyboardInterrupt:
        print("\nStopping.")
        return 0
    except Failure as failure:
        print(failure)
        return 1
    finally:
        stop(server)


class Failure(Exception):
    """The service could not be shown at work; the message says why."""


def interrupt(_signum: int, _frame: FrameType | None) -> NoReturn:
    """Treat a request to end like Ctrl-C."""
    raise KeyboardInterrupt


def read_port(text: str) -> int | None:
    """The port to serve on, or None, with a line that says why, when it cannot be had."""
    if not text.isdigit() or not 0 < int(text) < 65536:
        print(f"PORT is {text!r}; expected a number from 1 to 65535.")
        return None
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, int(text)))
        except OSError as error:
            print(f"Port {text} of {HOST} cannot be used ({error.strerror}). Choose another: make run PORT=8001")
            return None
    return int(text)


def start(port: int) -> subprocess.Popen[bytes]:
    """The service, in its own session so that it is told to end by us and by nobody else."""
    serve = [sys.executable, "-m", "service.cli", "serve", "--host", HOST, "--port", str(port)]
    environment = {"MAT_LOG_LEVEL": "warning", **os.environ}
    return subprocess.Popen(serve, cwd=ROOT, env=environment, start_new_session=True)


def stop(server: subprocess.Popen[bytes]) -> None:
    """End the service, kindly at first."""
    server.terminate()
    try:
        server.wait(10)
    except subprocess.TimeoutExpired:
        server.kill()
        server.wait()


def wait_until_ready(server: subprocess.Popen[bytes], base: str) -> None:
    """Show the progress of loading until the service takes requests."""
    begun = time.monotonic()
    shown = ""
    while time.monotonic() - begun < START_SECONDS:
        if server.poll() is not None:
            raise Failure(f"The service ended while starting, exit code {server.returncode}; see above.")
        status, content = get(f"{base}/readyz")
        if status == 200:
            print(f"Ready after {time.monotonic() - begun:.1f} s.")
            return
        if content.get("failed"):
            raise Failure("The workers could not be loaded; see above.")
        line = content.get("detail", "Starting the service.")
        if line != shown:
            print(line)
            shown = line
        time.sleep(0.1)
    raise Failure(f"The service was not ready after {START_SECONDS} s.")


def get(url: str) -> tuple[int, Json]:
    """Status and content of a JSON address; status 0 while nobody listens."""
    try:
        with urllib.request.urlopen(url, timeout=5) as response:
            return response.status, json.load(response)
    except urllib.error.HTTPError as error:
        return error.code, json.load(error)
    except (OSError, HTTPException):
        return 0, {}


def post(url: str, body: bytes, accept: str) -> tuple[bytes, float]:
    """The answer to a domain, and the milliseconds from sending to having it."""
    headers = {"Content-Type": "application/json", "Accept": accept}
    begun = time.perf_counter()
    try:
        with urllib.request.urlopen(urllib.request.Request(url, body, headers), timeout=60) as response:
            content = response.read()
    except urllib.error.HTTPError as error:
        raise Failure(f"The example was refused: {error.read().decode()}") from error
    return content, 1000 * (time.perf_counter() - begun)


def show_example(base: str) -> None:
    """POST the example for its answer and for its picture, and say what came."""
    body = EXAMPLE.read_bytes()
    domain = json.loads(body)
    content, milliseconds = post(f"{base}/v1/mat", body, "application/json")
    answer = json.loads(content)
    picture, _ = post(f"{base}/v1/mat", body, "image/svg+xml")
    PICTURE.parent.mkdir(exist_ok=True)
    PICTURE.write_bytes(picture)
    graph = answer["graph"]
    holes = len(domain.get("holes", []))
    print(
        f"\nPOST {EXAMPLE.relative_to(ROOT)} ({domain['name']}, {answer['domain']['edges']} edges, {holes} hole)\n"
        f"  nodes        {len(graph['nodes'])}\n"
        f"  segments     {len(answer['segments'])}\n"
        f"  cycles       {graph['cycles']}\n"
        f"  certificate  {'passed' if answer['certificate']['passed'] else 'failed'}\n"
        f"  time         {milliseconds:.1f} ms, there and back\n"
        f"  picture      {PICTURE.relative_to(ROOT)}"
    )


if __name__ == "__main__":
    sys.exit(main())

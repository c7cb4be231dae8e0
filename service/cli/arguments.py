"""The command line: what may be said, and the help that tells so."""

from __future__ import annotations

import argparse
import contextlib
import os
from collections.abc import Callable, Sequence
from typing import TypeVar

from service import __version__
from service.cli.exits import EXITS

N = TypeVar("N", int, float)

FORMATS = ("json", "geojson", "svg", "dxf", "msgpack")
LINE_FORMATS = ("json", "geojson")
"""Formats that fit one line."""

EPILOG = "exit codes:\n" + "\n".join(f"  {code:<4} {meaning}" for code, meaning in EXITS.items())


def parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    """What was asked for; ends the process with a usage message (exit code 2) where that cannot be told."""
    return parser().parse_args(arguments)


def parser() -> argparse.ArgumentParser:
    """The parser of the whole command line."""
    mat = argparse.ArgumentParser(
        prog="mat",
        description="Certified medial axis transforms of planar domains bounded by rational B-splines.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    mat.add_argument("--version", action="version", version=f"mat {__version__}")
    commands = mat.add_subparsers(dest="command", required=True, metavar="COMMAND")
    _solve(commands.add_parser("solve", help="solve one domain"))
    _batch(commands.add_parser("batch", help="solve many domains, one a line"))
    _check(commands.add_parser("check", help="tell whether domains are valid, or stored answers right"))
    _outlines(commands.add_parser("outlines", help="read domains from an SVG, DXF, GeoJSON or font file"))
    _serve(commands.add_parser("serve", help="serve over HTTP; the MAT_* variables are its settings"))
    return mat


def _solve(command: argparse.ArgumentParser) -> None:
    command.description = "Solve one domain; the answer is what POST /v1/mat answers, or what another operation does."
    command.add_argument("input", help="a JSON document; - is standard input; .gz is unpacked")
    command.add_argument("-o", "--output", default="-", help="where to write (default: standard output); .gz is packed")
    command.add_argument("-f", "--format", choices=FORMATS, help="default: by the name of the output, else json")
    _options(command)


def _batch(command: argparse.ArgumentParser) -> None:
    command.description = (
        "Solve many domains. Each line of the output is the answer to a line of the input, in order, or the problem document that"
        " says why there is none. Blank lines have no answer."
    )
    command.add_argument("input", help="JSON lines, one domain each; - is standard input; .gz is unpacked")
    command.add_argument("output", help="JSON lines; - is standard output; .gz is packed")
    workers, seconds = _number(int, 1, 256), _number(float, 0.05, 86_400.0)
    command.add_argument("-w", "--workers", type=workers, default=_cores(), help="processes that solve (default: %(default)s)")
    command.add_argument("-f", "--format", choices=LINE_FORMATS, default="json", help="of each answer (default: json)")
    command.add_argument("--deadline", type=seconds, help="longest time for a domain, seconds (default: MAT_DEADLINE_SECONDS)")
    there = command.add_mutually_exclusive_group()
    there.add_argument(
        "--resume", action="store_true", help="go on after the last whole line of the output; the input must be the same"
    )
    there.add_argument("--force", action="store_true", help="overwrite an output that is there")
    _options(command)


def _check(command: argparse.ArgumentParser) -> None:
    command.description = (
        "Tell whether files hold valid domains, and all problems of those that do not; nothing is solved. With --domain, certify"
        " stored answers anew: the nodes, graph and curves that a file holds are judged by the certificate on that domain."
    )
    command.add_argument("input", nargs="+", help="a JSON document; - is standard input; .gz is unpacked")
    command.add_argument("--domain", metavar="FILE", help="the domain whose answers the inputs are (default: they are domains)")


def _outlines(command: argparse.ArgumentParser) -> None:
    command.description = (
        "Write the domains that a file bounds, one JSON domain a line, for mat batch or for the body of a request. Curves stay"
        " what they are. What bounds nothing is told on standard error."
    )
    command.add_argument("input", help="an .svg, .dxf, .geojson, .ttf, .otf, .ttc or .woff file")
    command.add_argument("-o", "--output", default="-", help="where to write (default: standard output); .gz is packed")
    command.add_argument("--characters", metavar="TEXT", help="fonts: which to draw, such as 'Qa&'")
    command.add_argument("--flip", action="store_true", default=None, help="SVG: turn the y axis up")
    command.add_argument("--layer", action="append", metavar="NAME", help="DXF: a layer to read; may be repeated (default: all)")
    gap = _number(float, 0.0, 0.01)
    command.add_argument("--gap", type=gap, help="DXF: join ends nearer than this fraction of the size (default: 1e-6)")


def _serve(command: argparse.ArgumentParser) -> None:
    command.description = "Serve over HTTP until a signal asks for an orderly end."
    command.add_argument("--host", default="127.0.0.1", help="address to listen on (default: %(default)s)")
    port = _number(int, 0, 65535, "; 0 takes a free one")
    command.add_argument("--port", type=port, default=8000, help="port to listen on (default: %(default)s)")


def _options(command: argparse.ArgumentParser) -> None:
    """What goes before the members of the same name in the document."""
    command.add_argument("--operation", default="mat", metavar="NAME", help="mat, offset, width and so on (default: mat)")
    command.add_argument("--arguments", metavar="JSON", help="the operation's, such as '{\"distance\": 0.2}'")
    digits = _number(int, 3, 15)
    command.add_argument("--precision", type=digits, help="significant digits of coordinates and radii (default: all)")
    options = command.add_argument_group("options of the solver, which go before the document's own")
    options.add_argument("--tolerance", type=float, help="largest error of fitted curves, as a fraction of the size")
    options.add_argument("--method", choices=("discs", "march"))
    options.add_argument("--step", type=float, help="largest spacing of sample points")
    options.add_argument("--smooth-angle", type=float, help="a corner that turns by less, in radians, is smooth")
    options.add_argument("--samples", action="store_true", default=None, help="answer sample points, too")


def _number(kind: type[N], low: N, high: N, note: str = "") -> Callable[[str], N]:
    """What reads a number, and refuses one out of its range in words."""

    def read(text: str) -> N:
        with contextlib.suppress(ValueError):
            if low <= (value := kind(text)) <= high:
                return value
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from {low:g} to {high:g}{note}")

    return read


def _cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1

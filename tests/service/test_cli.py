"""The command ``mat``, as scripts and people meet it: what it writes, what it says, and how it ends."""

from __future__ import annotations

import contextlib
import gzip
import json
import os
import pty
import signal
import socket
import subprocess
import sys
import termios
import time
import tomllib
from pathlib import Path

import pytest

import mat_core
from service.cli import EXTRA, main
from service.cli.arguments import FORMATS, parse, parser
from service.cli.batch import settings_of
from service.cli.exits import BROKEN_PIPE, EXITS, FAILED, INVALID_INPUT, NOT_CERTIFIED, OF_CODE, OK, SOME_FAILED, USAGE
from service.cli.files import SCRATCH, scratch
from service.cli.serve import listen
from service.errors import ERRORS
from service.http.negotiation import FORMATS as SERVED
from service.http.negotiation import PRECISION_RANGE
from service.workers.solve import handle
from tests.service.live import ROOT, free_port
from tests.service.processes import alive, descendants, eventually

EXAMPLES = ROOT / "openapi" / "examples"
PLATE = EXAMPLES / "plate.json"
COMMAND = [sys.executable, "-m", "service.cli"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}
START_SECONDS = 180

BOW = {"outer": [{"degree": 1, "control_points": [a, b]} for a, b in [
    ([0, 0], [2, 2]), ([2, 2], [2, 0]), ([2, 0], [0, 2]), ([0, 2], [0, 0]),
]]}  # fmt: skip


def square(size: float) -> str:
    corners = [[0, 0], [size, 0], [size, size], [0, size]]
    return json.dumps({"outer": [{"degree": 1, "control_points": [corners[i - 1], corners[i]]} for i in range(4)]})


def run(*arguments: object, stdin: bytes | None = None, **environment: str) -> subprocess.CompletedProcess[bytes]:
    command = [*COMMAND, *map(str, arguments)]
    return subprocess.run(command, env={**ENVIRONMENT, **environment}, input=stdin, capture_output=True, timeout=START_SECONDS)


def answer(path: Path = PLATE, **told: str) -> bytes:
    meta, content = handle({"operation": "mat", "format": "json", "keep": None, "precision": None} | told, path.read_bytes())
    assert "error" not in meta
    return content


# solve ---------------------------------------------------------------------------------------------------------------
def test_an_answer_is_the_service_s_own(tmp_path: Path) -> None:
    out = tmp_path / "answer.json"
    assert main(["solve", str(PLATE), "-o", str(out)]) == OK
    assert out.read_bytes() == answer()
    assert [path.name for path in tmp_path.iterdir()] == ["answer.json"]
    assert out.stat().st_mode & 0o777 == 0o644


@pytest.mark.parametrize("form", ["geojson", "svg", "dxf", "msgpack"])
def test_the_name_of_the_output_tells_the_format(tmp_path: Path, form: str) -> None:
    for name, arguments in ((f"a.{form}", []), ("a.out", ["-f", form])):
        assert main(["solve", str(PLATE), "-o", str(tmp_path / name), *arguments]) == OK
    one, other = ((tmp_path / name).read_bytes() for name in (f"a.{form}", "a.out"))
    assert len(one) == len(other)
    assert form == "dxf" or one == other == answer(format=form)


def test_standard_streams_and_packed_files(tmp_path: Path) -> None:
    packed, out = tmp_path / "plate.json.gz", tmp_path / "answer.json.gz"
    packed.write_bytes(gzip.compress(PLATE.read_bytes()))
    assert run("solve", "-", stdin=PLATE.read_bytes()).stdout == answer() + b"\n"
    assert main(["solve", str(packed), "-o", str(out)]) == OK
    assert gzip.decompress(out.read_bytes()) == answer()


def test_options_go_before_those_of_the_document(tmp_path: Path) -> None:
    document = json.loads(PLATE.read_text()) | {"options": {"tolerance": 1e-3, "samples": False}}
    given, out = tmp_path / "in.json", tmp_path / "out.json"
    given.write_text(json.dumps(document))
    assert main(["solve", str(given), "-o", str(out), "--tolerance", "1e-5", "--samples", "--smooth-angle", "1e-5"]) == OK
    document["options"] = {"tolerance": 1e-5, "samples": True, "smooth_angle": 1e-5}
    given.write_text(json.dumps(document))
    assert out.read_bytes() == answer(given)


def test_digits_are_those_asked_for(tmp_path: Path) -> None:
    out = tmp_path / "answer.json"
    assert main(["solve", str(PLATE), "-o", str(out), "--precision", "5"]) == OK
    meta, content = handle({"operation": "mat", "format": "json", "precision": 5}, PLATE.read_bytes())
    assert out.read_bytes() == content != answer()


def test_an_operation_with_its_arguments(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "offset.json"
    assert main(["solve", str(PLATE), "--operation", "offset", "--arguments", '{"distance": 0.25}', "-o", str(out)]) == OK
    assert json.loads(out.read_bytes())["operation"] == "offset"
    assert main(["solve", str(PLATE), "--operation", "offset"]) == INVALID_INPUT
    assert "/arguments/distance" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--operation", "melt"], "there is no operation 'melt'"),
        (["--operation", "width", "-f", "svg"], "width is answered in json, msgpack, not in svg"),
        (["-f", "svg", "--precision", "5"], "--precision goes with json, geojson, msgpack, not with svg"),
        (["--arguments", "{"], "--arguments is not JSON"),
        (["--arguments", "[1]"], "--arguments must be a JSON object"),
        (["-o", "/nowhere/a.json"], "cannot write /nowhere/a.json: No such file or directory"),
    ],
)
def test_what_cannot_be_asked(arguments: list[str], said: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", str(PLATE), *arguments]) == USAGE
    assert said in capfd.readouterr().err


@pytest.mark.parametrize(
    ("content", "code", "said"),
    [
        (b'{"outer": [\n  1,\n ,2]}', INVALID_INPUT, ["in.json: Line 3, column 2: ", "[not-json]"]),
        (b"\xff\xfe", INVALID_INPUT, ["[not-json]"]),
        (b"", INVALID_INPUT, ["[not-json]"]),
        (json.dumps(BOW).encode(), INVALID_INPUT, ["1 problem [invalid-domain]", "/outer/0 at (1, 1): ", "[self-intersection]"]),
        (b'{"outer": [[NaN]]}', INVALID_INPUT, ["[invalid-domain]"]),
        (b'{"outer": [' + b",".join([b"0"] * 50) + b"]}", INVALID_INPUT, ["50 problems", "and 30 more"]),
    ],
)
def test_bad_input_is_told_with_its_place(
    content: bytes, code: int, said: list[str], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    given = tmp_path / "in.json"
    given.write_bytes(content)
    assert main(["solve", str(given)]) == code
    told = capfd.readouterr()
    assert told.out == ""
    assert all(part in told.err for part in said), told.err
    assert "Traceback" not in told.err


def test_an_axis_that_is_not_certified(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    def withheld(*_: object, **__: object) -> None:
        raise mat_core.NotCertified("a disc is not empty", (1.0, 2.0), {"passed": False})

    monkeypatch.setattr(mat_core, "medial_axis", withheld)
    assert main(["solve", str(PLATE)]) == NOT_CERTIFIED
    assert "at (1, 2): a disc is not empty" in capfd.readouterr().err


def test_files_that_cannot_be_read(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    cut = tmp_path / "cut.json.gz"
    cut.write_bytes(gzip.compress(PLATE.read_bytes())[:-20])
    plain = tmp_path / "plain.json.gz"
    plain.write_bytes(b"{}")
    for name, code, said in (
        (tmp_path / "none.json", USAGE, "No such file"), (tmp_path, USAGE, "Is a directory"),
        (cut, INVALID_INPUT, "not a whole gzip file"), (plain, INVALID_INPUT, "not a whole gzip file"),
    ):  # fmt: skip
        assert main(["solve", str(name)]) == code
        assert said in capfd.readouterr().err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full is Linux's")
def test_a_full_disk() -> None:
    ended = run("batch", "-", "/dev/full", stdin=square(1).encode())
    assert ended.returncode == FAILED
    assert b"No space left on device" in ended.stderr
    assert b"Traceback" not in ended.stderr


def test_a_reader_that_went_away() -> None:
    command, pipe = [*COMMAND, "solve", str(PLATE)], subprocess.PIPE
    with subprocess.Popen(command, env=ENVIRONMENT, stdout=pipe, stderr=pipe) as mat:
        assert mat.stdout is not None
        assert mat.stderr is not None
        mat.stdout.close()
        assert mat.stderr.read() == b""
        assert mat.wait(START_SECONDS) == BROKEN_PIPE


def test_a_solver_is_interrupted_at_once(tmp_path: Path) -> None:
    """Even in a compiled loop, which never looks at signals; here it is a call that keeps the interpreter's lock."""
    loop = "lambda *_, **__: (print(flush=True), [ctypes.PyDLL(None).sleep(9) for _ in range(9)])"
    (tmp_path / "sitecustomize.py").write_text(
        "import ctypes, functools, mat_core\n"
        f"mat_core.medial_axis = functools.wraps(mat_core.medial_axis)({loop})\n"
    )
    environment = {**ENVIRONMENT, "PYTHONPATH": f"{tmp_path}:{ROOT}"}
    with subprocess.Popen([*COMMAND, "solve", str(PLATE)], env=environment, stdout=subprocess.PIPE) as mat:
        assert mat.stdout is not None
        mat.stdout.readline()
        mat.send_signal(signal.SIGINT)
        assert mat.wait(20) == -signal.SIGINT  # 130 to a shell


# check ---------------------------------------------------------------------------------------------------------------
def test_valid_domains_are_told_with_their_figures(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", *map(str, sorted(EXAMPLES.glob("*.json")))]) == OK
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(list(EXAMPLES.glob("*.json")))
    assert f"{EXAMPLES / 'rectangle.json'}: valid, 4 edges in 1 loop, area 8" in lines


def test_what_was_healed_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = tmp_path / "gap.json"
    given.write_text(square(1).replace("[1, 0]", "[1.00000000001, 0]", 1))
    assert main(["check", str(given)]) == OK
    assert "\n  /outer/" in capsys.readouterr().out


def test_all_problems_of_all_files_are_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bow, words = tmp_path / "bow.json", tmp_path / "words.json"
    bow.write_text(json.dumps(BOW))
    words.write_text("words")
    assert main(["check", str(words), str(bow), str(PLATE)]) == INVALID_INPUT
    told = capsys.readouterr()
    assert "line 1, column 1" in told.err
    assert "at (1, 1): " in told.err
    assert "plate.json: valid" in told.out


def test_an_answer_is_told_from_a_domain(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    answer = tmp_path / "answer.json"
    assert main(["solve", str(PLATE), "-o", str(answer)]) == OK
    assert main(["check", str(answer)]) == INVALID_INPUT
    assert "an answer, not a domain" in capsys.readouterr().err


@pytest.mark.parametrize(("given", "expected"), [({}, "low"), ({"MAT_LONG_PRIORITY": "idle"}, "idle")])
def test_a_batch_s_workers_have_a_low_priority_unless_told_otherwise(
    monkeypatch: pytest.MonkeyPatch, given: dict[str, str], expected: str
) -> None:
    monkeypatch.delenv("MAT_LONG_PRIORITY", raising=False)
    for name, value in given.items():
        monkeypatch.setenv(name, value)
    asked = parse(["batch", "in.jsonl", "out.jsonl", "--workers", "3"])
    settings = settings_of(asked)
    assert (settings.long_priority, settings.workers) == (expected, 3)


def test_a_check_reads_what_a_solver_reads(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for content in (b"[" * 100_000, b"1" * 5000, b"\xff", b"NaN", b"", b'{"outer": [[1e999]]}'):
        given = tmp_path / "in.json"
        given.write_bytes(content)
        assert main(["check", str(given)]) == main(["solve", str(given)]) == INVALID_INPUT
        assert "Traceback" not in capsys.readouterr().err


# batch ---------------------------------------------------------------------------------------------------------------
LINES = [square(1), "", "{", square(2), '{"outer": 3}', "   ", square(3)]
EXPECTED = ["answer", "not-json", "answer", "invalid-domain", "answer"]


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> list[bytes]:
    """The result lines of `LINES`."""
    folder = tmp_path_factory.mktemp("batch")
    (folder / "in.jsonl").write_text("\n".join(LINES))
    ended = run("batch", folder / "in.jsonl", folder / "out.jsonl", "--workers", 2)
    assert ended.returncode == SOME_FAILED
    assert ended.stderr.endswith(b"2 of 5 domains were not solved (1 not-json, 1 invalid-domain); their lines say why\n")
    assert (folder / "out.jsonl").read_bytes().endswith(b"\n")
    return (folder / "out.jsonl").read_bytes().splitlines()


def kind(line: bytes) -> str:
    document = json.loads(line)
    return "answer" if "segments" in document else str(document["code"])


def test_a_batch_answers_every_line_in_order(solved: list[bytes]) -> None:
    assert [kind(line) for line in solved] == EXPECTED
    sizes = [json.loads(line)["domain"]["bbox"][2] for line in solved if kind(line) == "answer"]
    assert sizes == [1, 2, 3]
    assert next(json.loads(line)["line"] for line in solved if kind(line) != "answer") == 3


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("kept", [0, 2, 5])
def test_a_batch_goes_on_after_the_last_whole_line(tmp_path: Path, solved: list[bytes], kept: int, packed: bool) -> None:
    given, out = tmp_path / "in.jsonl.gz", tmp_path / ("out.jsonl.gz" if packed else "out.jsonl")
    given.write_bytes(gzip.compress("\n".join(LINES).encode()))
    marks = [b'{"kept": true}\n'] * kept
    torn = solved[0][:100]
    out.write_bytes(b"".join(map(gzip.compress, marks)) + gzip.compress(torn)[:-5] if packed else b"".join(marks) + torn)
    ended = run("batch", given, out, "--workers", 1, "--resume")
    assert ended.returncode == (SOME_FAILED if kept < 5 else OK)
    written = gzip.decompress(out.read_bytes()) if packed else out.read_bytes()
    assert written.splitlines(keepends=True)[:kept] == marks
    assert written.splitlines()[kept:] == solved[kept:]


def test_an_output_is_not_overwritten_by_accident(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    given, out = tmp_path / "in.jsonl", tmp_path / "out.jsonl"
    given.write_text(square(1))
    out.write_text("precious\n")
    for arguments, said in (
        ([given, out], "--resume goes on"), ([given, given], "is the input"), ([given, "-", "--resume"], "read back"),
        ([given, "/nowhere/out"], "No such file"), ([given, out, "--resume", "--operation", "x"], "no operation"),
    ):  # fmt: skip
        assert main(["batch", *map(str, arguments)]) == USAGE
        assert said in capfd.readouterr().err
    assert out.read_text() == "precious\n"


def test_an_output_of_another_input_is_not_resumed(tmp_path: Path) -> None:
    (tmp_path / "in.jsonl").write_text(square(1))
    (tmp_path / "out.jsonl").write_text("{}\n{}\n{}\n")
    ended = run("batch", tmp_path / "in.jsonl", tmp_path / "out.jsonl", "--resume")
    assert ended.returncode == USAGE
    assert b"belongs to another input" in ended.stderr
    assert b"Traceback" not in ended.stderr


MANY = 600


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_a_batch_that_is_stopped_leaves_whole_lines_and_no_process(tmp_path: Path, how: signal.Signals) -> None:
    given, out, temporary = tmp_path / "in.jsonl", tmp_path / "out.jsonl", tmp_path / "temporary"
    temporary.mkdir()
    environment = {**ENVIRONMENT, "TMPDIR": str(temporary)}
    given.write_text("\n".join(square(1 + i) for i in range(MANY)))
    with subprocess.Popen([*COMMAND, "batch", str(given), str(out), "-w", "2"], env=environment, stderr=subprocess.PIPE) as mat:
        eventually(lambda: out.exists() and out.stat().st_size > 0, START_SECONDS)
        below = descendants(mat.pid)
        mat.send_signal(how)
        assert mat.wait(30) == {signal.SIGKILL: -9, signal.SIGINT: 130, signal.SIGTERM: 143}[how]
        assert mat.stderr is not None
        assert b"Traceback" not in mat.stderr.read()
    eventually(lambda: not any(alive(pid) for pid in below))
    before = out.read_bytes()
    assert before.endswith(b"\n")
    done = before.count(b"\n")
    assert 0 < done < MANY
    ended = run("batch", given, out, "-w", "2", "--resume", TMPDIR=str(temporary))
    assert ended.returncode == OK, ended.stderr
    assert not list(temporary.glob(f"{SCRATCH}*")), "nobody's folder stays"
    lines = out.read_bytes().splitlines()
    assert out.read_bytes().startswith(before)
    assert [json.loads(line)["domain"]["bbox"][2] for line in lines] == [1 + i for i in range(MANY)]


def test_folders_of_the_dead_are_removed_and_of_the_living_are_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / f"{SCRATCH}left").mkdir()
    (tmp_path / f"{SCRATCH}left" / "0").write_text("{}")
    (tmp_path / "of somebody else").mkdir()
    with scratch() as mine, scratch() as other:
        assert {folder.name for folder in tmp_path.iterdir()} == {mine.name, other.name, "of somebody else"}
    assert [folder.name for folder in tmp_path.iterdir()] == ["of somebody else"]


def test_a_terminal_sees_how_far_it_is(tmp_path: Path) -> None:
    (tmp_path / "in.jsonl").write_text("\n".join(square(1 + i) for i in range(20)))
    ours, its = pty.openpty()
    termios.tcsetwinsize(its, (24, 80))
    command = [*COMMAND, "batch", str(tmp_path / "in.jsonl"), str(tmp_path / "out.jsonl"), "-w", "1"]
    ended = subprocess.run(command, env=ENVIRONMENT, stderr=its, timeout=START_SECONDS)
    os.close(its)
    seen = b""
    with contextlib.suppress(OSError):  # how a terminal says that nobody writes any more
        while block := os.read(ours, 4096):
            seen += block
    os.close(ours)
    assert ended.returncode == OK
    assert b"20/20" in seen


# serve ---------------------------------------------------------------------------------------------------------------
def test_a_taken_port_and_a_bad_setting(capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as holder:
        port = str(holder.getsockname()[1])
        assert main(["serve", "--port", port]) == USAGE
        assert f"port {port} of 127.0.0.1 cannot be used: Address already in use" in capfd.readouterr().err
    monkeypatch.setenv("MAT_WORKERS", "many")
    assert main(["serve", "--port", str(free_port())]) == USAGE
    assert "MAT_WORKERS is 'many'" in capfd.readouterr().err


def test_a_socket_is_one_of_tcp_so_that_answers_leave_at_once() -> None:
    for host in ("127.0.0.1", "localhost"):
        with listen(host, 0) as listening:
            assert listening.proto == socket.IPPROTO_TCP
            with socket.create_connection(listening.getsockname()[:2]), listening.accept()[0] as accepted:
                assert accepted.proto == socket.IPPROTO_TCP


# the command itself --------------------------------------------------------------------------------------------------
def test_help_names_every_exit_code_and_needs_nothing_installed() -> None:
    program = "import sys; from service.cli import main; main(['--help'])"
    ended = subprocess.run([sys.executable, "-S", "-c", program], env=ENVIRONMENT, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert all(f"  {code:<4} {meaning}" in ended.stdout for code, meaning in EXITS.items())


@pytest.mark.parametrize(
    ("arguments", "missing"), [(["serve"], "uvicorn"), (["batch", "-", "-"], "tqdm"), (["solve", str(PLATE)], "orjson")]
)
def test_a_missing_extra_is_named(arguments: list[str], missing: str) -> None:
    program = f"import sys; sys.modules[{missing!r}] = None; from service.cli import main; sys.exit(main({arguments!r}))"
    ended = subprocess.run([sys.executable, "-c", program], env=ENVIRONMENT, capture_output=True, text=True, input="")
    assert ended.returncode == USAGE
    assert ended.stderr == f"mat: this needs {missing}, which comes with the extra 'service': pip install 'mat-core[service]'\n"


def test_every_package_of_the_service_is_known_to_come_with_it() -> None:
    optional = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    named = {line.split(">")[0].replace("-", "_") for line in optional["service"]}
    assert named <= EXTRA


def test_the_command_offers_what_the_service_offers() -> None:
    assert set(FORMATS) == set(SERVED)
    low, high = PRECISION_RANGE
    for digits in (low, high):
        assert parser().parse_args(["solve", "-", "--precision", str(digits)]).precision == digits
    for digits in (low - 1, high + 1):
        with pytest.raises(SystemExit):
            parser().parse_args(["solve", "-", "--precision", str(digits)])


def test_every_error_has_an_exit_code() -> None:
    assert set(OF_CODE) < set(ERRORS)
    assert set(OF_CODE.values()) <= set(EXITS)


def test_the_program_is_installed_under_its_name() -> None:
    assert tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"] == {"mat": "service.cli:main"}


def test_nothing_is_slow_before_it_is_needed() -> None:
    program = "import sys, service.cli; sys.exit(bool({'numpy', 'fastapi', 'pydantic'} & set(sys.modules)))"
    begun = time.monotonic()
    assert subprocess.run([sys.executable, "-c", program], env=ENVIRONMENT, check=False).returncode == 0
    assert time.monotonic() - begun < 20

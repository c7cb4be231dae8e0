"""Builds the virtual environment .venv from a lock file; does nothing when it is already as the lock file says.

Run by the interpreter at hand, whatever its version: ``python3 tools/environment.py requirements.lock``. It uses
nothing but the standard library, and no syntax newer than Python 3.6, so that an old interpreter gets an answer instead
of a SyntaxError.
"""

import hashlib
import os
import subprocess
import sys

OLDEST = (3, 11)
ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
VENV = os.path.join(ROOT, ".venv")
PYTHON = os.path.join(VENV, "bin", "python")


def main():
    """Make the environment fit the lock file named on the command line; exit with a clear line where that fails."""
    lock = os.path.join(ROOT, sys.argv[1])
    if sys.version_info < OLDEST:
        have = "{}.{}".format(*sys.version_info[:2])
        need = "Python 3.11 or later is needed, this is " + have + " (" + sys.executable + ")."
        stop(need + "\nName another one: make run PYTHON=python3.12")
    if not usable():
        say("creating the environment .venv (Python {}.{})".format(*sys.version_info[:2]))
        if run([sys.executable, "-m", "venv", "--clear", VENV]) != 0:
            stop("The environment could not be created; on Debian and Ubuntu the package python3-venv is needed.")
    stamp = os.path.join(VENV, "." + os.path.basename(lock) + ".installed")
    with open(lock, "rb") as content:
        wanted = hashlib.sha256(content.read()).hexdigest()
    if read(stamp) == wanted:
        return
    say("installing what " + os.path.basename(lock) + " lists (once; about a minute)")
    install = ["-m", "pip", "install", "-qq", "--disable-pip-version-check", "--require-hashes", "-r", lock]
    if run([PYTHON, *install]) != 0:
        stop("The packages could not be installed; see the lines above. Is there a way to the package index?")
    with open(stamp, "w") as file:
        file.write(wanted)


def usable():
    """Whether .venv has an interpreter that starts and is new enough."""
    check = "import sys; sys.exit(sys.version_info < (3, 11))"
    return os.path.exists(PYTHON) and run([PYTHON, "-c", check]) == 0


def run(command):
    """The exit code of a command whose output goes where ours goes."""
    return subprocess.call(command, cwd=ROOT)


def read(path):
    """The text of a file, empty when it is not there."""
    try:
        with open(path) as file:
            return file.read()
    except OSError:
        return ""


def say(line):
    """Tell what is going on."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def stop(line):
    """End with a reason."""
    sys.stderr.write(line + "\n")
    sys.exit(1)


if __name__ == "__main__":
    main()

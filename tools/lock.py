"""Resolves the dependencies of pyproject.toml into the two lock files: hashes for every platform, no index address.

requirements.lock is what the service needs to run; requirements-dev.lock is that and the tools of the tests.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COMMON = ["--universal", "--python-version", "3.11", "--generate-hashes", "--no-annotate", "--no-header"]
RUN = ["--extra", "service", "--extra", "telemetry"]
PARTS = {
    "requirements.lock": RUN,
    "requirements-dev.lock": [*RUN, "--group", "dev", "--constraint", "requirements.lock"],
}


def main() -> int:
    """Write both files; 1 when uv is not there or finds no solution."""
    for name, selection in PARTS.items():
        command = ["uv", "pip", "compile", "--quiet", *COMMON, *selection, "-o", name, "pyproject.toml"]
        if "--upgrade" in sys.argv:
            command.insert(3, "--upgrade")
        try:
            subprocess.run(command, cwd=ROOT, check=True)
        except FileNotFoundError:
            print("uv is needed to resolve dependencies: pip install uv")
            return 1
        except subprocess.CalledProcessError:
            return 1
        print(f"wrote {name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

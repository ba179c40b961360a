"""What the tests share: the command to compare with, and surfaces."""

import json
import os
import subprocess
from pathlib import Path

import pytest

import cones

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def command():
    """The command ``cones`` of this checkout, or of $CONES."""
    program = Path(os.environ.get("CONES", ROOT / "target" / "release" / "cones"))
    if not program.exists():
        pytest.skip(f"the command is not built: {program}")

    def run(*arguments):
        done = subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(done.stderr)
        return done.stdout

    run.program = program
    return run


@pytest.fixture(scope="session")
def hare():
    return cones.shape("hare", 1500)


def report(path):
    return json.loads(Path(path).read_text())

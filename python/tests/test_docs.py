"""What the documentation shows is run: Python as it stands, commands with what they print. Its Rust runs with `cargo test`."""

import doctest
import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: Pages, and what their code needs.
PAGES = {
    "python/README.md": ["dask"],
    "docs/index.md": [],
    "docs/tutorials/scan.md": [],
    "docs/tutorials/blender.md": ["bpy"],
    "docs/tutorials/peaks.md": ["matplotlib"],
    "docs/tutorials/network.md": ["networkx", "matplotlib"],
    "docs/tutorials/volume.md": ["zarr", "distributed", "matplotlib"],
}
#: Pictures that no code of a page writes: what one sees in Blender's and the browser's windows.
DRAWN_ELSEWHERE = {"view.png"}


def blocks(page):
    """The fenced blocks of a page: language, text and the line they begin at."""
    text = page.read_text()
    for block in re.finditer(r"^```(\w*)[^\n]*\n(.*?)^```$", text, re.M | re.S):
        yield block.group(1), block.group(2), text[: block.start()].count("\n") + 1


FIGURE = r"[-−]?\d[\d,.]*"


def expected_lines(lines):
    """A pattern of what is printed, whose groups are the figures: runs of blanks are one; `…` stands for anything, alone on a line for any
    lines."""
    parts = []
    for line in map(" ".join, map(str.split, lines)):
        words = re.sub(rf"({FIGURE})|(…)|([^\d−…-]+|.)", lambda part: f"({FIGURE})" if part[1] else ".*" if part[2] else re.escape(part[3]), line)
        parts.append(r"(?:.*\n)*?" if line == "…" else words + r"\n")
    return re.compile("".join(parts))


def is_same(shown, printed):
    """Whether a figure is one that a page shows: whole numbers are the same, others within half a hundredth or one in their last digit, as
    they may be on another machine."""
    shown, printed = (figure.rstrip(",.").replace(",", "").replace("−", "-") for figure in (shown, printed))
    decimals = len(shown.partition(".")[2])
    return shown == printed or decimals > 0 and abs(float(shown) - float(printed)) <= max(0.005 * abs(float(shown)), 1.01 * 10**-decimals)


def is_printed(shown, printed):
    """Whether lines that a page shows are what was printed."""
    found = expected_lines(shown).fullmatch("".join(f"{' '.join(line.split())}\n" for line in printed.splitlines()))
    figures = [figure for line in shown for figure in re.findall(FIGURE, line)]
    return bool(found) and all(map(is_same, figures, found.groups()))


def run_console(text, command, folder, where):
    """Runs the lines that begin with `$`, and compares what each prints with the lines below it."""
    environment = {**os.environ, "PATH": f"{Path(command.program).parent}{os.pathsep}{os.environ['PATH']}"}
    for asked in re.split(r"^\$ ", text, flags=re.M)[1:]:
        line, *shown = asked.splitlines()
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", line], cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        assert done.returncode == 0, f"{where}: {line}\n{done.stdout}"
        assert not shown or is_printed(shown, done.stdout), f"{where}: {line}\n{done.stdout}"


def run_in_blender(page):
    """Runs the Python of a page in a process of its own: Blender is a program, with threads that do not bear a fork."""
    text = "".join(text for language, text, _ in blocks(page) if language == "python")
    path = os.pathsep.join(filter(None, [str(ROOT / "blender"), os.environ.get("PYTHONPATH")]))
    done = subprocess.run([sys.executable, "-c", text], env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", PAGES)
def test_the_code_of_a_page_runs(name, tmp_path, monkeypatch, request):
    for needed in PAGES[name]:
        # Not imported: Blender's modules change a process that they are loaded into.
        if importlib.util.find_spec(needed) is None:
            pytest.skip(f"{needed} is not installed")
    monkeypatch.chdir(tmp_path)
    page = ROOT / name
    names: dict = {"__name__": "__main__"}
    ran = 0
    if "bpy" in PAGES[name]:
        run_in_blender(page)
        ran = 1
    for language, text, line in blocks(page):
        assert language in ("python", "console", "rust", "sh"), f"{name}, line {line}: nothing runs {language!r}"
        if language == "python" and "bpy" not in PAGES[name]:
            exec(compile("\n" * line + text, str(page), "exec"), names)
        elif language == "console":
            run_console(text, request.getfixturevalue("command"), tmp_path, f"{name}, line {line}")
        ran += language in ("python", "console")
    assert ran
    for picture in re.findall(r"!\[.*?\]\((?:.*/)?(.*?)\)", page.read_text()):
        assert picture in DRAWN_ELSEWHERE or (tmp_path / picture).exists(), f"no code of {name} draws {picture}"
    if name == "python/README.md":
        assert "missing.obj" in names["items"][-1].error and (tmp_path / "out" / "part0.obj").exists()


def test_all_pages_are_run_and_their_rust_too():
    tested = (ROOT / "tests/src/lib.rs").read_text()
    for page in (ROOT / "docs").rglob("*.md"):
        name = page.relative_to(ROOT).as_posix()
        languages = {language for language, _, _ in blocks(page)}
        assert not languages & {"python", "console"} or name in PAGES, name
        assert "sh" not in languages, f"{name}: nothing runs blocks of sh; console shows what is printed"
        assert "rust" not in languages or f"../../{name}" in tested, f"{name} is not among the documentation tests of {ROOT}/tests"


@pytest.mark.parametrize("shown, printed, fits", [
    (["a 1.25 b", "…", "end"], "a 1.25  b\nx\ny\nend\n", True),
    (["a … c"], "a b b c\n", True),
    (["a 1"], "b 1\n", False),
    (["a"], "a\nb\n", False),
    (["#  552,289 of −3.", "1  …"], "# 552,289 of −3.\n1 9 9\n", True),
    (["552,281 edges"], "552,289 edges\n", False),
    (["fill 43.6 %, 1.04"], "fill 43.5 %, 1.05\n", True),
    (["fill 43.2 %"], "fill 43.6 %\n", False),
    (["seams 3.84"], "seams 3.75\n", False),
    (["… 31"], "4 32\n", False),
])  # fmt: skip
def test_what_is_printed_is_compared_with_its_figures(shown, printed, fits):
    assert is_printed(shown, printed) == fits


@pytest.mark.parametrize("name", ["cones", "cones.analysis", "cones.topo"])
def test_the_examples_of_modules_are_right(name):
    failed, tried = doctest.testmod(importlib.import_module(name))
    assert tried and not failed


def test_everything_public_is_documented():
    import inspect

    for name in ("cones", "cones.topo", "cones.plot", "cones.topo.plot", "cones.dask"):
        module = importlib.import_module(name)
        for public in getattr(module, "__all__", [n for n, v in vars(module).items() if inspect.isfunction(v) and n[0] != "_"]):
            thing = getattr(module, public)
            if inspect.isfunction(thing) or inspect.isclass(thing):
                assert thing.__doc__, f"{name}.{public}"
                for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                    if member[0] != "_" and (inspect.isfunction(value) or isinstance(value, property)):
                        assert value.__doc__, f"{name}.{public}.{member}"

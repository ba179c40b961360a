"""What the documentation shows is run."""

import doctest
import importlib
import re
from pathlib import Path

import pytest

README = Path(__file__).resolve().parents[1] / "README.md"


def test_the_code_of_the_tutorial_runs(tmp_path, monkeypatch):
    pytest.importorskip("dask")
    monkeypatch.chdir(tmp_path)
    blocks = list(re.finditer(r"^```python\n(.*?)^```$", README.read_text(), re.M | re.S))
    assert len(blocks) > 8
    names: dict = {}
    for block in blocks:
        line = README.read_text()[: block.start()].count("\n") + 1
        exec(compile("\n" * line + block.group(1), str(README), "exec"), names)
    assert "missing.obj" in names["items"][-1].error and (tmp_path / "out" / "part0.obj").exists()


@pytest.mark.parametrize("name", ["cones", "cones.analysis", "cones.topo"])
def test_the_examples_of_modules_are_right(name):
    failed, tried = doctest.testmod(importlib.import_module(name))
    assert tried and not failed


def test_everything_public_is_documented():
    import inspect

    for name in ("cones", "cones.topo", "cones.plot", "cones.topo.plot"):
        module = importlib.import_module(name)
        for public in getattr(module, "__all__", [n for n, v in vars(module).items() if inspect.isfunction(v) and n[0] != "_"]):
            thing = getattr(module, public)
            if inspect.isfunction(thing) or inspect.isclass(thing):
                assert thing.__doc__, f"{name}.{public}"
                for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                    if member[0] != "_" and (inspect.isfunction(value) or isinstance(value, property)):
                        assert value.__doc__, f"{name}.{public}.{member}"

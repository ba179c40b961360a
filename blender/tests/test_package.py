"""The packed extension: what is in it, and that Blender installs it, wheel and all ($CONES_WHEEL names one)."""

import os
import subprocess
import sys
import textwrap
import zipfile
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import package  # noqa: E402


def test_the_zip_holds_manifest_code_and_wheel(tmp_path):
    tomllib = pytest.importorskip("tomllib")
    for tag, platform in [
        ("manylinux_2_34_x86_64", "linux-x64"),
        ("macosx_11_0_arm64", "macos-arm64"),
        ("win_amd64", "windows-x64"),
    ]:
        wheel = tmp_path / f"cones-0.1.0-cp39-abi3-{tag}.whl"
        wheel.write_bytes(b"a wheel")
        path = package.package(wheel, tmp_path)
        with zipfile.ZipFile(path) as archive:
            manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
            assert manifest["wheels"] == [f"./wheels/{wheel.name}"] and manifest["platforms"] == [platform]
            assert manifest["blender_version_min"] == "4.2.0" and manifest["id"] == "cone_unwrap"
            assert archive.read(f"wheels/{wheel.name}") == b"a wheel"
            assert {"__init__.py", "operator.py", "exchange.py"} <= set(archive.namelist())
            assert not any("test" in name or "__pycache__" in name for name in archive.namelist())


def test_blender_installs_and_runs_it(tmp_path):
    pytest.importorskip("bpy")
    wheel = os.environ.get("CONES_WHEEL")
    if not wheel:
        pytest.skip("CONES_WHEEL names no wheel")
    path = package.package(Path(wheel), tmp_path)
    user = str(tmp_path / "user")
    script = f"""
        import importlib.machinery, sys

        class OfTheExtension:
            # This Python may have the package too: only the extension's wheel is to be found.
            def find_spec(self, name, path=None, target=None):
                if name != "cones":
                    return None
                found = importlib.machinery.PathFinder.find_spec(name, [path for path in sys.path if path.startswith({user!r})])
                if found is None:
                    raise ModuleNotFoundError("the extension has brought no cones")
                return found

        sys.meta_path.insert(0, OfTheExtension())
        import bpy
        bpy.ops.extensions.package_install_files(filepath={str(path)!r}, repo="user_default", enable_on_install=True)
        bpy.ops.mesh.primitive_monkey_add()
        print(bpy.ops.uv.cone_unwrap(number="COUNT", count=20))
        import cones
        print(cones.__file__)
    """
    environment = {**os.environ, "BLENDER_USER_RESOURCES": user, "PYTHONPATH": ""}
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "{'FINISHED'}" in done.stdout
    assert done.stdout.splitlines()[-1].startswith(user)

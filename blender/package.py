"""Packs the extension, with the wheel of the Python package inside: `python blender/package.py [FOLDER]` prints the .zip.

Needs Rust and pip. The wheel is for this platform and for every Python from 3.9 on, so one zip serves Blender 4.2 and later. `--wheel FILE`
takes a wheel that was built already, for another platform for example.
"""

import argparse
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
#: What Blender calls the platforms of wheels.
PLATFORMS = [
    (r"manylinux.*_x86_64|linux_x86_64", "linux-x64"),
    (r"manylinux.*_aarch64|linux_aarch64", "linux-arm64"),
    (r"macosx.*_arm64", "macos-arm64"),
    (r"macosx.*_x86_64", "macos-x64"),
    (r"win_amd64", "windows-x64"),
    (r"win_arm64", "windows-arm64"),
]


def build_wheel(folder):
    """The wheel of the Python package, built here."""
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", str(folder), str(HERE.parent / "python")]
    subprocess.run(command, check=True)
    return next(Path(folder).glob("cones-*.whl"))


def platform(wheel):
    """Blender's name of the platform that a wheel is for."""
    for pattern, name in PLATFORMS:
        if re.search(pattern, wheel.name):
            return name
    raise SystemExit(f"{wheel.name} is for no platform that Blender runs on")


def package(wheel, folder):
    """Writes the .zip."""
    manifest = (HERE / "cone_unwrap" / "blender_manifest.toml").read_text()
    name = platform(wheel)
    manifest = manifest.replace("wheels = []", f'wheels = ["./wheels/{wheel.name}"]\nplatforms = ["{name}"]')
    version = re.search(r'^version = "(.*)"', manifest, re.M).group(1)
    path = Path(folder) / f"cone_unwrap-{version}-{name}.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", manifest)
        for source in sorted((HERE / "cone_unwrap").glob("*.py")):
            archive.write(source, source.name)
        archive.write(wheel, f"wheels/{wheel.name}")
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", default=".", type=Path)
    parser.add_argument("--wheel", type=Path)
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    if arguments.wheel:
        print(package(arguments.wheel, arguments.folder))
        return
    with tempfile.TemporaryDirectory() as folder:
        print(package(build_wheel(folder), arguments.folder))


if __name__ == "__main__":
    main()

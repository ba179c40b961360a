"""What the site needs beside its pages: the Rust API as `cargo doc` has written it, if it has."""

import os
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def on_post_build(config):
    """Copies the pages of rustdoc to `api/rustdoc`."""
    pages = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "doc"
    if (pages / "cones").is_dir():
        shutil.copytree(pages, Path(config["site_dir"]) / "api" / "rustdoc", dirs_exist_ok=True)

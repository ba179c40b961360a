#!/usr/bin/env python3
"""Unwraps meshes of the collection and has each map measured by the independent judge, which must find no fault and the
same numbers as the program's own report.

    judge.py PROGRAM JUDGE MESHES
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

CONES = {
    "hemisphere_2051.obj": 8, "spot_2930.obj": 8, "punctured_torus_4599.obj": 8, "table1/fandisk_6475.obj": 8,
    "table1/octaflower_7994.obj": 8, "table1/moai_10002.obj": 8, "rocker_arm_10044.obj": 8, "camelhead_11381.off": 8,
    "face_17157.obj": 8, "beetle_19887.off": 8, "threeholes_3596.off": 16, "fertility_4494.off": 16, "casting_5096.obj": 24,
}


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE).stdout


def faults(judged, reported):
    """What is wrong with a map: the judge's verdict, and where the report disagrees with it."""
    ours = reported["distortion"]
    limits = {"flipped": 0, "degenerate_uv": judged["degenerate_3d"], "overlap": 0}
    if reported["seams"]["freed_parts"] == 0:
        limits |= {"seam_mismatch": 1e-6, "seam_K_med": 1e-6}
    found = [f"{key} is {judged[key]}" for key, limit in limits.items() if judged[key] > limit]
    if not judged["all_disks"]:
        found.append("an island is no disk")
    pairs = [("quasi-conformal", judged["qc_mean"], ours["quasi_conformal"]["mean"]),
             ("area", judged["area_D"], ours["area_mean"]), ("log scale", judged["u_L2_c"], ours["u_l2"])]
    if reported["seams"]["opened_handles"] == 0:  # their loops are seams for the judge alone
        pairs.append(("seam mismatch", 1 + judged["seam_mismatch"], 1 + reported["seams"]["mismatch"]))
    found += [f"the report's {what} is {b}, the judge's {a}" for what, a, b in pairs if abs(a - b) > 1e-6 * a]
    return found


def main(program, judge, meshes):
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        out, report = Path(folder, "out.obj"), Path(folder, "report.json")
        for name, count in CONES.items():
            mesh = Path(meshes, name)
            if not mesh.is_file():
                print(f"skipped: {name} is missing")
                continue
            for free in ("never", "auto", "always"):
                run(program, "unwrap", mesh, "-n", count, "-o", out, "--report", report, "--free-seams", free)
                judged = json.loads(run(sys.executable, judge, mesh, out, "--json"))
                reported = json.loads(report.read_text())
                found = faults(judged, reported)
                if free == "never" and reported["seams"]["freed_parts"]:
                    found.append("seams are not rigid")
                failed |= bool(found)
                told = f"quasi-conformal {judged['qc_mean']:.4f}, area {judged['area_D']:.3f}"
                print(f"{name:28} {count:3} cones, free seams {free:6}   {told}   {'; '.join(found) or 'ok'}", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

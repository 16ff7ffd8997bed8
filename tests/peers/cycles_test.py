#!/usr/bin/env python3
"""Keylume's pictures against path tracing by Blender Cycles: four frames of one example.

usage: cycles_test.py EXAMPLE KEYLUME [--halves SAMPLES] [--frames FRAME...] [--references-only]
exit 0: every frame within its limits; 1: not; 77: Blender or OpenImageIO for Python is not installed.

Pictures, figures and the references, which take hours once, lie in build/peers/EXAMPLE.
"""
import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

SKIPPED = 77
try:
    import peer_scene
    import picture_difference
except ImportError as missing:
    print(f"skipped: {missing}; install python3-numpy and python3-openimageio")
    sys.exit(SKIPPED)

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
WIDTH, HEIGHT = 320, 180
RMSE_MAX = 0.02
HALVES = 2  # independent renderings, from which the noise of the reference is known
FRAMES = {"garage": (9, 30, 83, 110), "room": (9, 39, 69, 99), "cornell_box": (0, 16, 32, 47)}
LIGHTING = {
    "garage": {"preset": "standard", "samples_per_light": 64, "line_count": 16_000_000, "moving_line_count": 8_000_000},
    "room": {"preset": "high", "tolerance": 0.05, "patch_edge_m": 0.05, "samples_per_light": 256},
    "cornell_box": {"preset": "high", "tolerance": 0.05, "patch_edge_m": 0.05, "samples_per_light": 512,
                    "line_count": 64_000_000, "moving_line_count": 16_000_000},
}


class Folders:
    def __init__(self, example):
        self.example = ROOT / "api/examples" / example
        self.base = ROOT / "build/peers" / example
        self.references = self.base / "references"
        self.references.mkdir(parents=True, exist_ok=True)

    def artefacts(self, name):
        return self.base / name / "artefacts"


def run_job(folders, keylume, name, lighting, **image):
    """Renders the example as the job `name` -> its description."""
    job = folders.base / name
    shutil.rmtree(job, ignore_errors=True)
    shutil.copytree(folders.example, job / "input")
    description = json.loads((job / "input/animation.json").read_text())
    description["lighting"] = lighting
    camera = description["images"][0]["camera"]
    description["images"] = [{"camera": camera, "width": WIDTH, "height": HEIGHT, **image}]
    (job / "input/animation.json").write_text(json.dumps(description))
    subprocess.run([keylume, "render", str(job)], check=True, stdin=subprocess.DEVNULL)
    return description


def reference_files(folders, scene, frame, camera, samples):
    """The halves of the reference, rendered unless they are there from before."""
    files = []
    for seed in range(1, HALVES + 1):
        described = {**scene.frame(frame, camera), "width": WIDTH, "height": HEIGHT, "samples": samples, "seed": seed}
        text = json.dumps(json.loads(json.dumps(described), parse_float=lambda x: round(float(x), 7)), sort_keys=True)
        text_and_script = text + (HERE / "cycles_render.py").read_text()
        digest = hashlib.sha256(text_and_script.encode()).hexdigest()[:12]
        out = folders.references / f"{frame:04}-{samples}-{seed}-{digest}.exr"
        files.append(out)
        if out.exists():
            continue
        described_file, unfinished = out.with_suffix(".json"), out.with_name("unfinished.exr")
        described_file.write_text(text)
        print(f"Cycles: frame {frame}, {samples} samples, seed {seed}", flush=True)
        with open(out.with_suffix(".log"), "w", encoding="utf-8") as log:
            subprocess.run(["nice", "-n", "19", "blender", "-b", "--factory-startup", "--python-exit-code", "1", "--python",
                            str(HERE / "cycles_render.py"), "--", str(described_file), str(unfinished)],
                           check=True, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT)
        os.replace(unfinished, out)
    return files


def our_picture(folders, camera, frame):
    (path,) = sorted(folders.artefacts("job").glob(f"images/{camera}/*{frame:04}.exr"))
    return picture_difference.rgb(picture_difference.read_channels(path))


def report_text(example, samples, rows):
    lines = [f"# {example}: Keylume against Blender Cycles, {HALVES} x {samples} samples, {WIDTH} x {HEIGHT}", "",
             "RMSE and mean difference are relative to the mean radiance of the pixels compared; the RMSE holds the noise of the",
             "reference, told apart by its halves. Left out are pixels near edges of direct light, the share in brackets: 10 %, or",
             "the strongest if those are too many. Pictures: ours, theirs, difference (red: ours brighter; full at 10 %).",
             "", "| frame | RMSE | of it noise of the reference | mean difference | left out (edges from) | RMSE with edges |",
             "|--:|--:|--:|--:|--:|--:|"]
    for frame, found in rows:
        lines.append(f"| {frame} | {found.rmse:.2%} | {found.noise:.2%} | {found.bias:+.2%} |"
                     f" {found.left_out_share:.1%} ({found.weakest_edge:.0%}) | {found.rmse_with_edges:.2%} |")
    lines += [""] + [f"![frame {frame}]({frame:04}.png)" for frame, _ in rows]
    return "\n".join(lines) + "\n"


def problems_of(frame, found):
    if found.rmse > RMSE_MAX:
        yield f"frame {frame}: RMSE {found.rmse:.2%}, at most {RMSE_MAX:.0%}"


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("example", choices=sorted(FRAMES))
    parser.add_argument("keylume")
    parser.add_argument("--halves", type=int, default=2048, metavar="SAMPLES")
    parser.add_argument("--frames", type=int, nargs="+", help="only these")
    parser.add_argument("--references-only", action="store_true")
    return parser.parse_args()


def main():
    options = arguments()
    if not shutil.which("blender"):
        print("skipped: blender is not installed")
        return SKIPPED
    folders = Folders(options.example)
    if options.references_only:
        description = run_job(folders, options.keylume, "poses", {"preset": "draft"}, formats=["png"])
        poses = folders.artefacts("poses")
    else:
        description = run_job(folders, options.keylume, "job", LIGHTING[options.example], formats=["exr"],
                              samples_per_pixel=64)
        poses = folders.artefacts("job")
    camera = description["images"][0]["camera"]
    scene = peer_scene.PeerScene(folders.example, "animation.json", poses / "patches.npz")
    rows, problems = [], []
    for frame in options.frames or FRAMES[options.example]:
        files = reference_files(folders, scene, frame, camera, options.halves)
        if options.references_only:
            continue
        reference, ours = picture_difference.Reference(files), our_picture(folders, camera, frame)
        found = picture_difference.Comparison(ours, reference)
        picture_difference.write_sheet(folders.base / f"{frame:04}.png", ours, reference, found)
        rows.append((frame, found))
        problems += problems_of(frame, found)
    if rows:
        text = report_text(options.example, options.halves, rows)
        (folders.base / "report.md").write_text(text)
        print(text + "\n".join(problems))
    return 1 if problems else 0


sys.exit(main())

"""Jobs for tests, cut down from the examples: fewer frames, coarser patches, smaller images."""
import json
import shutil
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parent.parent.parent / "api/examples"


def squeezed(node, factor):
    """The same motion in fewer frames: key frames times `factor`, of two that meet the first stays."""
    if isinstance(node, list):
        return [squeezed(item, factor) for item in node]
    if not isinstance(node, dict):
        return node
    result = {name: squeezed(value, factor) for name, value in node.items()}
    if isinstance(result.get("keys"), list):
        kept = {}
        for key in result["keys"]:
            kept.setdefault(int(key["frame"] * factor), {**key, "frame": int(key["frame"] * factor)})
        result["keys"] = [kept[frame] for frame in sorted(kept)]
    if isinstance(result.get("matrices"), list):
        matrices = result["matrices"]
        result["matrices"] = [matrices[int(i / factor)] for i in range(int(len(matrices) * factor))]
    return result


def write_job(folder, example="garage", frames=12, width=64, height=36, **lighting):
    """Writes scene.obj, the MTL and animation.json into `folder` (made here) -> folder"""
    source = EXAMPLES / example
    folder.mkdir(parents=True)
    job = json.loads((source / "animation.json").read_text())
    all_frames = job.get("frames", {}).get("count", 1)
    frames = min(frames, all_frames)
    if frames < all_frames:
        job = squeezed(job, frames / all_frames)
    job["frames"] = {**job.get("frames", {}), "count": frames}
    job["lighting"] = {"preset": "draft", **lighting}
    for image in job["images"]:
        image.update(width=width, height=height)
    (folder / "animation.json").write_text(json.dumps(job))
    shutil.copy(next(source.glob("*.obj")), folder / "scene.obj")
    for path in source.glob("*.mtl"):
        shutil.copy(path, folder)
    return folder


def changed(job_folder, change):
    """Applies `change` to the job's animation.json."""
    path = job_folder / "animation.json"
    job = json.loads(path.read_text())
    change(job)
    path.write_text(json.dumps(job))

"""One frame of an example as plain polygons in the world, read from its OBJ, MTL and JSON without Keylume's parser.

Only the poses come from Keylume (patches.npz of a job): how keys are joined is documented, but not what is compared here.
"""
import json

import numpy

NO_EMISSION = (0.0, 0.0, 0.0)


def read_mtl(path):
    """name -> reflectance and emitted radiance."""
    materials, name = {}, None
    for line in path.read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "newmtl":
            name = rest[0]
            materials[name] = {"reflectance": (0.0,) * 3, "radiance": NO_EMISSION}
        elif word == "Kd":
            materials[name]["reflectance"] = tuple(map(float, rest))
        elif word == "Ke":
            materials[name]["radiance"] = tuple(map(float, rest))
        elif word.startswith("map_"):
            raise ValueError(f"{path}: textures are not compared")
    return materials


def read_obj(path):
    """(material files, polygons as (object, material, corners in OBJ units))."""
    vertices, polygons, libraries = [], [], []
    thing, material = "", ""
    for line in path.read_text().splitlines():
        word, *rest = line.split() or [""]
        if word == "v":
            vertices.append(tuple(map(float, rest[:3])))
        elif word == "o":
            thing = rest[0]
        elif word == "usemtl":
            material = rest[0]
        elif word == "mtllib":
            libraries += rest
        elif word == "f":
            numbers = [int(corner.split("/")[0]) for corner in rest]
            polygons.append((thing, material, [vertices[n - 1 if n > 0 else n] for n in numbers]))
        elif word == "g":
            raise ValueError(f"{path}: groups are not compared")
    return libraries, polygons


def number_at(track, frame):
    """Value of a linear or one-key JSON track at a frame."""
    if not isinstance(track, dict):
        return numpy.asarray(track, float)
    if track.get("interpolation", "linear") != "linear":
        raise ValueError("only linear tracks of cameras and lights are compared")
    frames = [key["frame"] for key in track["keys"]]
    values = numpy.atleast_2d([numpy.atleast_1d(key["value"]) for key in track["keys"]]).astype(float)
    return numpy.array([numpy.interp(frame, frames, column) for column in values.T])


def materials_at(libraries, settings, frame):
    """As animation.json changes them: exitance is pi times the radiance."""
    materials = {}
    for library in libraries:
        materials.update(read_mtl(library))
    for name, material in materials.items():
        given = settings.get(name, {})
        material["both_sides"] = given.get("sides", "both") == "both"
        for field, to, factor in (("reflectance", "reflectance", 1), ("exitance_w_m2", "radiance", 1 / numpy.pi)):
            if field in given:
                material[to] = tuple(float(x) for x in numpy.broadcast_to(number_at(given[field], frame) * factor, 3))
    return materials


class PeerScene:
    """An example's folder, and the poses a job of it left."""

    def __init__(self, folder, animation_name, patches_npz):
        self.description = json.loads((folder / animation_name).read_text())
        libraries, self.polygons = read_obj(folder / "scene.obj")
        self.libraries = [folder / name for name in libraries]
        with numpy.load(patches_npz) as arrays:
            self.object_names = [str(name) for name in arrays["object_names"]]
            self.poses, self.visible = arrays["poses"], arrays["visible"]

    def frame(self, frame, camera_name):
        """What Cycles needs of a frame, in metres."""
        metres = self.description.get("metres_per_unit", 1)
        animated = self.description.get("objects", {})
        placed = []
        for thing, material, corners in self.polygons:
            index = self.object_names.index(thing if thing in animated else "")
            if not self.visible[index, frame]:
                continue
            pose = self.poses[index, frame]
            world = numpy.asarray(corners) * metres @ pose[:, :3].T + pose[:, 3]
            placed.append({"material": material, "corners": world.tolist()})
        camera = self.description["cameras"][camera_name]
        y_up = self.description.get("up", "y") == "y"
        return {
            "materials": materials_at(self.libraries, self.description.get("materials", {}), frame),
            "polygons": placed,
            "camera": {
                "position": (number_at(camera["position"], frame) * metres).tolist(),
                "target": (number_at(camera["target"], frame) * metres).tolist(),
                "up": [0, 1, 0] if y_up else [0, 0, 1],
                "vertical_fov_degrees": float(number_at(camera.get("vertical_fov_degrees", 50), frame)),
            },
        }

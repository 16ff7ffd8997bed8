"""Bakes the light of one frame into the vertices of its patches with Blender Cycles, and tells how long that took.

usage: blender -b --factory-startup --python-exit-code 1 --python cycles_bake.py -- SCENE.json OUT.json

SCENE.json is what `keylume bench peers` writes: materials, facets in metres (origin, edges u and v, cut into parts),
and the sample counts. Each is baked with two seeds; their difference is the noise. OUT.json has the results.
Nothing is clamped or cut off. Only baking is timed, not starting Blender or building the scene.
"""
import json
import math
import sys
import time

import bpy

INSET = 1e-4  # share by which points are drawn into their facet: none lies in another facet's plane
SEEDS = (1, 2)


def shader_of(name, material):
    """Reflects and emits on the front; the back absorbs everything."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    diffuse, black = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*material["reflectance"], 1)
    black.inputs["Color"].default_value = (0, 0, 0, 1)
    emission, front = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeAddShader")
    emission.inputs["Color"].default_value = (*material["radiance"], 1)
    emission.inputs["Strength"].default_value = 1 if any(material["radiance"]) else 0
    links.new(diffuse.outputs[0], front.inputs[0])
    links.new(emission.outputs[0], front.inputs[1])
    mix, geometry, output = nodes.new("ShaderNodeMixShader"), nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeOutputMaterial")
    links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    links.new(front.outputs[0], mix.inputs[1])
    links.new(black.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], output.inputs["Surface"])
    return made


def grid_of(facet, first):
    """Points of a facet's grid and its quads, counter-clockwise; points are numbered from `first`."""
    parts_u, parts_v = facet["parts"]
    points, faces = [], []
    for j in range(parts_v + 1):
        for i in range(parts_u + 1):
            s, t = (INSET + (1 - 2 * INSET) * share for share in (i / parts_u, j / parts_v))
            points.append([o + s * u + t * v for o, u, v in zip(facet["origin"], facet["u"], facet["v"])])
    for j in range(parts_v):
        for i in range(parts_u):
            a = first + j * (parts_u + 1) + i
            faces.append((a, a + 1, a + parts_u + 2, a + parts_u + 1))
    return points, faces


def add_object(scene, name, facets, shaders):
    """One mesh of these facets, a slot for each material."""
    points, faces, slots, materials = [], [], [], sorted({facet["material"] for facet in facets})
    for facet in facets:
        more_points, more_faces = grid_of(facet, len(points))
        points += more_points
        faces += more_faces
        slots += [materials.index(facet["material"])] * len(more_faces)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    for material in materials:
        mesh.materials.append(shaders[material])
    mesh.polygons.foreach_set("material_index", slots)
    made = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(made)
    return made


def choose_settings(scene):
    scene.render.engine = "CYCLES"
    scene.render.threads_mode = "AUTO"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = 1024  # roulette ends paths
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0


def bake(scene, thing, samples, seed):
    """-> (seconds, mean of the channels of every vertex)"""
    scene.cycles.samples, scene.cycles.seed = samples, seed
    begin = time.perf_counter()
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT", "COLOR"}, target="VERTEX_COLORS")
    seconds = time.perf_counter() - begin
    colours = thing.data.color_attributes.active_color.data
    values = [0.0] * (4 * len(colours))
    colours.foreach_get("color", values)
    return seconds, [sum(values[k:k + 3]) / 3 for k in range(0, len(values), 4)]


def noise_of(mesh, one, other):
    """Root mean square error of a patch, the mean of its corners, over the mean of all, weighted by area.

    That of either bake: their difference has twice the variance.
    """
    weights = squares = total = 0
    for face in mesh.polygons:
        a, b = (sum(values[k] for k in face.vertices) / len(face.vertices) for values in (one, other))
        weights += face.area
        squares += face.area * (a - b) ** 2
        total += face.area * (a + b) / 2
    return math.sqrt(squares / weights / 2) / (total / weights)


def main():
    scene_file, out = sys.argv[sys.argv.index("--") + 1:]
    with open(scene_file, encoding="utf-8") as file:
        described = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    shaders = {name: shader_of(name, material) for name, material in described["materials"].items()}
    emitting = {name for name, material in described["materials"].items() if any(material["radiance"])}
    for number, facet in enumerate(described["facets"]):
        if facet["material"] in emitting:  # each a light that Cycles samples
            add_object(scene, f"lamp{number}", [facet], shaders)
    lit = add_object(scene, "lit", [f for f in described["facets"] if f["material"] not in emitting], shaders)
    lit.data.color_attributes.new("light", "FLOAT_COLOR", "POINT")
    bpy.context.view_layer.objects.active = lit
    lit.select_set(True)
    choose_settings(scene)
    results = []
    for samples in described["samples"]:
        bakes = [bake(scene, lit, samples, seed) for seed in SEEDS]
        results.append({"samples": samples, "seconds": [seconds for seconds, _ in bakes],
                        "rmse": noise_of(lit.data, bakes[0][1], bakes[1][1])})
    with open(out, "w", encoding="utf-8") as file:
        json.dump({"version": bpy.app.version_string, "points": len(lit.data.vertices), "bakes": results}, file)


main()

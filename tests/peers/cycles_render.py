"""Renders one picture with Blender Cycles: unbiased path tracing of diffuse surfaces, nothing clamped, smoothed or cut off.

usage: blender -b --factory-startup --python-exit-code 1 --python cycles_render.py -- SCENE.json OUT.exr

SCENE.json is what peer_scene.py writes; OUT.exr is a multi-layer EXR with the passes Combined, DiffDir, DiffCol and Emit.
"""
import json
import math
import sys

import bpy
from mathutils import Matrix, Vector


def shader_of(name, material):
    """Reflects on both sides, or the back absorbs everything; what it emits leaves the front."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()

    def node(kind, colour=None):
        added = nodes.new(kind)
        if colour is not None:
            added.inputs["Color"].default_value = (*colour, 1)
        return added

    diffuse = node("ShaderNodeBsdfDiffuse", material["reflectance"])
    emission = node("ShaderNodeEmission", material["radiance"])
    emission.inputs["Strength"].default_value = 1 if any(material["radiance"]) else 0
    front = node("ShaderNodeAddShader")
    links.new(diffuse.outputs[0], front.inputs[0])
    links.new(emission.outputs[0], front.inputs[1])
    back = node("ShaderNodeBsdfDiffuse", material["reflectance"] if material["both_sides"] else (0, 0, 0))
    mix, geometry, output = node("ShaderNodeMixShader"), node("ShaderNodeNewGeometry"), node("ShaderNodeOutputMaterial")
    links.new(geometry.outputs["Backfacing"], mix.inputs[0])
    links.new(front.outputs[0], mix.inputs[1])
    links.new(back.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], output.inputs["Surface"])
    return made


def add_polygons(scene, polygons, shaders):
    """One mesh per material, so that every lamp is a light that Cycles samples."""
    for material in sorted({polygon["material"] for polygon in polygons}):
        corners, faces = [], []
        for polygon in polygons:
            if polygon["material"] == material:
                faces.append(range(len(corners), len(corners) + len(polygon["corners"])))
                corners += polygon["corners"]
        mesh = bpy.data.meshes.new(material)
        mesh.from_pydata(corners, [], faces)
        mesh.materials.append(shaders[material])
        scene.collection.objects.link(bpy.data.objects.new(material, mesh))


def add_camera(scene, camera):
    forward = (Vector(camera["target"]) - Vector(camera["position"])).normalized()
    right = forward.cross(Vector(camera["up"])).normalized()
    axes = Matrix((right, right.cross(forward), -forward)).transposed()
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle_y = math.radians(camera["vertical_fov_degrees"])
    data.clip_start, data.clip_end = 1e-3, 1e4
    placed = bpy.data.objects.new("camera", data)
    placed.matrix_world = Matrix.Translation(camera["position"]) @ axes.to_4x4()
    scene.collection.objects.link(placed)
    scene.camera = placed


def choose_settings(scene, samples, seed):
    scene.render.engine = "CYCLES"
    scene.render.threads_mode = "AUTO"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples, cycles.seed = samples, seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = 1024  # roulette ends paths
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.pixel_filter_type = "BOX"



def choose_output(scene, width, height, path):
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth = "32"
    render.filepath = path
    layer = scene.view_layers[0]
    layer.use_pass_diffuse_direct = layer.use_pass_diffuse_color = layer.use_pass_emit = True
    scene.view_settings.view_transform = "Standard"  # files of linear values are not touched by it; so that none is in doubt


def main():
    scene_file, out = sys.argv[sys.argv.index("--") + 1:]
    with open(scene_file, encoding="utf-8") as file:
        described = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    shaders = {name: shader_of(name, material) for name, material in described["materials"].items()}
    add_polygons(scene, described["polygons"], shaders)
    add_camera(scene, described["camera"])
    choose_settings(scene, described["samples"], described["seed"])
    choose_output(scene, described["width"], described["height"], out)
    bpy.ops.render.render(write_still=True)


main()

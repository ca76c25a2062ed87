"""What runs within Blender: `python -m perception.training.blender_script JOB.json`.

One unit is a hundred pixels. The camera looks straight down without perspective, so places in
the image are those of the truth.
"""

import json
import sys
from importlib import import_module
from math import cos, pi, sin
from pathlib import Path
from typing import Any

# Not among the project's own needs: who wants Blender installs it beside them.
bpy: Any = import_module("bpy")

UNIT = 0.01


def main() -> None:
    """Show the job in a file, as `image.png` beside it."""
    path = Path(sys.argv[1])
    job = json.loads(path.read_text())
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for cable, grey in zip(job["scene"]["cables"], job["cables"], strict=True):
        _add_cable(job, cable, grey)
    for end in job["scene"]["ends"]:
        for number, outline in enumerate(end["outline_px"]):
            _add_block(job, outline, _block_height(job, end["covered"], number))
    _add_table(job)
    _add_light(job)
    _add_camera(job)
    _render(job, path.with_name("image.png"))


def _place(job: Any, x_px: float, y_px: float, height_px: float) -> tuple[float, float, float]:
    """Return a place of the image in the world; centres of pixels are whole numbers."""
    columns, rows = job["scene"]["size_px"]
    x, y = x_px - 0.5 * (columns - 1), 0.5 * (rows - 1) - y_px
    return (x * UNIT, y * UNIT, height_px * UNIT)


def _material(grey: float, roughness: float) -> Any:
    material = bpy.data.materials.new("grey")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    level = (grey / 255.0) ** 2.2
    shader.inputs["Base Color"].default_value = (level, level, level, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    return material


def _add(name: str, content: Any) -> Any:
    thing = bpy.data.objects.new(name, content)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def _add_cable(job: Any, cable: Any, grey: float) -> None:
    curve = bpy.data.curves.new("cable", "CURVE")
    curve.dimensions, curve.bevel_resolution, curve.use_fill_caps = "3D", 5, True
    curve.bevel_depth = 0.5 * cable["width_px"] * UNIT
    line = curve.splines.new("POLY")
    line.points.add(len(cable["points_px"]) - 1)
    width_px = job["scene"]["width_px"]
    for point, (x, y), height in zip(
        line.points, cable["points_px"], cable["heights"], strict=True
    ):
        point.co = (*_place(job, x, y, height * width_px), 1.0)
    curve.materials.append(_material(grey, job["roughness"]))
    _add("cable", curve)


def _block_height(job: Any, covered: bool, number: int) -> float:
    """Return the height of a part: flat below strands, else as high as a cable; none alike."""
    level: float = job["scene"]["width_px"] * ((0.02 if covered else 1.0) + 0.02 * number)
    return level


def _add_block(job: Any, outline: Any, height_px: float) -> None:
    """Add a part of a connector."""
    corners = [_place(job, x, y, level) for level in (0.0, height_px) for x, y in outline]
    count = len(outline)
    sides = [(k, (k + 1) % count, count + (k + 1) % count, count + k) for k in range(count)]
    mesh = bpy.data.meshes.new("connector")
    mesh.from_pydata(corners, [], [tuple(range(count)), tuple(range(count, 2 * count)), *sides])
    mesh.materials.append(_material(job["connector"], 0.5))
    _add("connector", mesh)


def _add_table(job: Any) -> None:
    side = max(job["scene"]["size_px"]) * UNIT
    mesh = bpy.data.meshes.new("table")
    corners = [(-side, -side, 0.0), (side, -side, 0.0), (side, side, 0.0), (-side, side, 0.0)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    material = _material(job["table"], 0.8)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    noise, ramp = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeValToRGB")
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 3.0, 8.0
    for element, share in zip(ramp.color_ramp.elements, (1.0, -1.0), strict=True):
        level = (min(job["table"] * (1.0 + share * job["grain"]), 255.0) / 255.0) ** 2.2
        element.color = (level, level, level, 1.0)
    links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    mesh.materials.append(material)
    _add("table", mesh)


def _add_light(job: Any) -> None:
    round_rad, slant_rad = job["sun_rad"]
    sun = bpy.data.lights.new("sun", "SUN")
    # Both lights together make white paper just white.
    sun.energy, sun.angle = pi * (1.0 - job["fill"]), job["sun_size_rad"]
    lamp = _add("sun", sun)
    lamp.rotation_euler = (slant_rad * cos(round_rad), slant_rad * sin(round_rad), 0.0)
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = job["fill"]
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    bpy.context.scene.world = world


def _add_camera(job: Any) -> None:
    lens = bpy.data.cameras.new("camera")
    lens.type, lens.ortho_scale = "ORTHO", max(job["scene"]["size_px"]) * UNIT
    camera = _add("camera", lens)
    camera.location = (0.0, 0.0, 20.0)
    bpy.context.scene.camera = camera


def _render(job: Any, out: Path) -> None:
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device = "CYCLES", "CPU"
    scene.cycles.samples, scene.cycles.use_denoising = job["samples"], False
    scene.render.resolution_x, scene.render.resolution_y = job["scene"]["size_px"]
    scene.render.resolution_percentage = 100
    scene.render.image_settings.color_mode = "BW"
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = str(out)
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main()

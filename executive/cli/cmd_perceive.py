"""`cellwright perceive`: what perception makes of images, without a cell or a mission."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import typer
from pydantic import JsonValue
from rich.table import Table
from rich.text import Text

from executive.cli.console import chatter, print_error, results, stdout_kept_for_the_result
from executive.cli.images import read_grey, write_image
from executive.core.errors import InputError

if TYPE_CHECKING:
    from perception.cable.types import CableScene, Points, Question
    from perception.camera import GreyImage

# Knots that are told of, the likeliest first.
MOST_KNOTS = 3

perceive = typer.Typer(help="Run perception on image files.", no_args_is_help=True)


@perceive.callback()
def _kinds() -> None:
    """Keep `cable` a command of its own while it is the only one."""


@perceive.command()
def cable(
    images: Annotated[list[Path], typer.Argument(metavar="IMAGE", help="Image files.")],
    start: Annotated[
        str | None,
        typer.Option(metavar="X,Y", help="Pixel to start tracing at; found when left out."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one line of JSON an image on stdout.")
    ] = False,
    vision: Annotated[
        Literal["learned", "classic"] | None,
        typer.Option(help="With networks, or without; with them where PyTorch is installed."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="PNG", dir_okay=False, help="Draw what is found; one image only."),
    ] = None,
) -> None:
    """Trace the cable in overhead images: ends, crossings, knots, and where to hold them."""
    from executive.app.compose import cable_vision

    if out is not None and len(images) > 1:
        raise InputError(f"--out {out}: got {len(images)} images; expected one, try one at a time")
    start_px = None if start is None else _point(start)
    with stdout_kept_for_the_result():
        eyes = cable_vision(kind=vision)
    failed = False
    for path in images:
        try:
            image = read_grey(path)
            _check_inside(path, image, start_px)
        except InputError as error:
            # The other images are still worth an answer.
            print_error(chatter(), str(error))
            failed = True
            continue
        with stdout_kept_for_the_result():
            scene = eyes.scene(image, start_px)
        _print_scene(path, scene, as_json)
        if out is not None:
            _draw(out, image, scene)
    if failed:
        raise typer.Exit(2)


def _point(text: str) -> "Points":
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--start {text}: expected X,Y in pixels; try --start 310,245") from None
    return np.array([[x, y]])


def _check_inside(path: Path, image: "GreyImage", start_px: "Points | None") -> None:
    if start_px is None:
        return
    height, width = image.shape
    x, y = start_px[0]
    if not (0 <= x < width and 0 <= y < height):
        raise InputError(
            f"{path}: --start {x:g},{y:g} lies outside; expected 0 to {width - 1} and "
            f"0 to {height - 1} px"
        )


def _print_scene(path: Path, scene: "CableScene", as_json: bool) -> None:
    if as_json:
        typer.echo(json.dumps(scene_document(path, scene)))
        return
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 0))
    ends = ", ".join(f"{trace.end} ({trace.probability:.2f})" for trace in scene.traces)
    table.add_row("traces", f"{len(scene.traces)}: {ends}" if ends else "none")
    table.add_row("endpoints", str(len(scene.endpoints)))
    table.add_row("crossings", str(len(scene.crossings)))
    table.add_row("knots", str(len(scene.knots)))
    table.add_row("P(knotted)", f"{scene.knotted_probability:.3f}")
    likeliest = [f"{knot.name} {knot.probability:.2f}" for knot in scene.knot_types[:MOST_KNOTS]]
    table.add_row("knot of the first", ", ".join(likeliest) or "unknown")
    if scene.telling is not None:
        x, y = scene.telling.position_px
        told = "which way at" if scene.telling.kind == "path" else "over or under at"
        table.add_row("most telling", f"{told} {x:.0f},{y:.0f} ({scene.telling.bits:.2f} bits)")
    table.add_row("took", f"{scene.seconds:.2f} s")
    results().print(Text(str(path), "bold"), table)


def _draw(out: Path, image: "GreyImage", scene: "CableScene") -> None:
    from perception.cable.draw import draw_scene

    write_image(out, draw_scene(image, scene))
    chatter().print(f"drawn: {out}")


def scene_document(path: Path, scene: "CableScene") -> JsonValue:
    """Return the line of JSON for one image."""
    return {
        "image": str(path),
        "traces": [
            {
                "points_px": _rounded(trace.points_px),
                "end": trace.end.value,
                "probability": float(trace.probability),
            }
            for trace in scene.traces
        ],
        "endpoints_px": [_rounded(endpoint.position_px) for endpoint in scene.endpoints],
        "crossings": [
            {
                "position_px": _rounded(crossing.position_px),
                "trace_over": int(crossing.trace_over),
                "arc_over": float(crossing.arc_over),
                "trace_under": int(crossing.trace_under),
                "arc_under": float(crossing.arc_under),
                "probability": float(crossing.probability),
            }
            for crossing in scene.crossings
        ],
        "knots": [
            {
                "interval": [float(position) for position in knot.interval],
                "first_undercrossing_px": _rounded(knot.first_undercrossing_px),
                "cage_px": _rounded(knot.cage_px),
                "pinch_px": _rounded(knot.pinch_px),
            }
            for knot in scene.knots
        ],
        "knotted_probability": float(scene.knotted_probability),
        "knot_types": {knot.name: float(knot.probability) for knot in scene.knot_types},
        "telling": None if scene.telling is None else _question(scene.telling),
        "seconds": float(scene.seconds),
    }


def _question(telling: "Question") -> JsonValue:
    return {
        "kind": telling.kind.value,
        "position_px": _rounded(telling.position_px),
        "bits": float(telling.bits),
    }


def _rounded(points_px: "Points") -> JsonValue:
    """Return image points to a hundredth of a pixel, which is finer than anything seen."""
    rounded: JsonValue = np.round(np.asarray(points_px, float), 2).tolist()
    return rounded

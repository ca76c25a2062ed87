"""`cellwright affinity`: which objects stand beside which, as language models have it."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.progress import Progress
from rich.table import Table

from executive.cli.console import chatter, results, stdout_kept_for_the_result
from executive.cli.images import write_image
from executive.core.errors import InputError

if TYPE_CHECKING:
    from perception.shelf.affinity import AffinityMatrix
    from perception.shelf.language.picking import Wanted
    from perception.shelf.language.scores import PairScores
    from simulation.shelf.taxonomy import Domain

# Neighbours that are told of each object, the likeliest first.
NEIGHBOURS = 3
MODELS_HELP = "Names of models that have scored it, with + between them."
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON on stdout.")]
DomainArgument = Annotated[
    str, typer.Argument(metavar="DOMAIN", help="pharmacy, kitchen, office, or a domain's YAML.")
]
RecipeOption = Annotated[
    str | None, typer.Option(metavar="NAME", help="thesis, prompts or symmetric.")
]

affinity = typer.Typer(
    help="Build, show and compare matrices of what stands beside what.", no_args_is_help=True
)


@affinity.command()
def build(
    domain: DomainArgument,
    out: Annotated[Path, typer.Option(metavar="FILE", help="JSON file for the matrix.")],
    model: Annotated[
        list[str] | None,
        typer.Option(
            metavar="MODEL",
            help="smollm2, gemma3, minilm, a folder, a .gguf file, http://..., or a matrix's "
            ".json; give it again to average several.",
        ),
    ] = None,
    recipe: RecipeOption = None,
    prompt: Annotated[
        list[str] | None,
        typer.Option(metavar="TEXT", help="What to ask, {X} for the object; again for more."),
    ] = None,
    served_model: Annotated[
        str, typer.Option(metavar="NAME", help="Model to ask for at an address.")
    ] = "",
    embeds: Annotated[
        bool, typer.Option(help="A model by path gives vectors, not probabilities.")
    ] = False,
    scores: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", file_okay=False, help="Keep each model's scores here, too."),
    ] = None,
) -> None:
    """Ask models how well a domain's objects go together, and store the matrix."""
    from perception.shelf.language.picking import Wanted
    from perception.shelf.language.prompts import PROMPTS, fill
    from perception.shelf.language.recipes import affinity_of
    from perception.shelf.language.stored import DEFAULT_MODELS, DEFAULT_RECIPE, recipe_of

    things = _domain(domain)
    how = recipe_of(recipe or ("prompts" if prompt else DEFAULT_RECIPE))
    wanted = Wanted(tuple(prompt) if prompt else PROMPTS, served_model, embeds)
    for text in wanted.prompts:
        fill(text, "")
    _check_writable(out)
    parts = [_asked(name, wanted, things, scores) for name in model or DEFAULT_MODELS.split("+")]
    matrix = affinity_of(parts, how)
    _check_writable(out)
    matrix.save(out)
    chatter().print(f"written: {out}: {len(matrix.names)} objects, {matrix.origin.model}")


@affinity.command()
def show(
    what: Annotated[
        str, typer.Argument(metavar="WHAT", help="pharmacy, kitchen, office, or a matrix's .json.")
    ],
    thing: Annotated[
        str | None, typer.Argument(metavar="[OBJECT]", help="One object, with all its neighbours.")
    ] = None,
    models: Annotated[str | None, typer.Option(metavar="NAMES", help=MODELS_HELP)] = None,
    recipe: RecipeOption = None,
    temperature: Annotated[
        float, typer.Option(metavar="T", help="Above 1 evens rows out, below sharpens them.")
    ] = 1.0,
    out: Annotated[
        Path | None, typer.Option(metavar="PNG", dir_okay=False, help="Draw it as a heat map.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Show a stored matrix: who goes with whom."""
    matrix = _matrix(what, models, recipe).tempered(temperature)
    if as_json:
        typer.echo(json.dumps(_document(matrix, thing)))
    else:
        _print_matrix(matrix, thing)
    if out is not None:
        from perception.shelf.affinity_picture import affinity_picture

        write_image(out, affinity_picture(matrix))
        chatter().print(f"drawn: {out}")


@affinity.command()
def compare(
    domain: DomainArgument,
    matrices: Annotated[
        list[Path] | None, typer.Argument(metavar="[FILE]...", help="Matrices of your own.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Hold matrices against the domain's taxonomy, which none of them was made from."""
    from perception.shelf.affinity import load_affinity
    from perception.shelf.language.comparing import Agreement, agreement, stored_agreements
    from simulation.shelf.taxonomy import taxonomy_affinity

    things = _domain(domain)
    truth = taxonomy_affinity(things)
    rows: list[Agreement] = stored_agreements(things.names, things.name, truth)
    rows += [
        agreement(str(path), load_affinity(path), things.names, truth) for path in matrices or []
    ]
    if as_json:
        typer.echo(json.dumps([row.document() for row in rows]))
        return
    table = Table(box=None, padding=(0, 3, 0, 0))
    for heading in ("matrix", "divergence", "of neighbours", "best in category"):
        table.add_column(heading, justify="left" if heading == "matrix" else "right")
    for row in rows:
        table.add_row(
            row.name, f"{row.with_diagonal:.3f}", f"{row.of_neighbours:.3f}", f"{row.nearest:.0%}"
        )
    results().print(table)


def _asked(name: str, wanted: "Wanted", things: "Domain", folder: Path | None) -> "PairScores":
    from perception.shelf.language.picking import provider_of

    chatter().print(f"loading {name}")
    with (
        stdout_kept_for_the_result(),
        provider_of(name, wanted) as provider,
        Progress(console=chatter(), transient=True) as bar,
    ):
        task = bar.add_task(f"asking {name}", total=None)
        answer = provider.score(
            things.names, lambda done, of: bar.update(task, completed=done, total=of)
        )
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{things.name}.{answer.source.model}.json"
        answer.save(path)
        chatter().print(f"written: {path}")
    return answer


def _domain(text: str) -> "Domain":
    from simulation.shelf.taxonomy import read_domain, shipped_domain

    return read_domain(Path(text)) if text.endswith((".yaml", ".yml")) else shipped_domain(text)


def _matrix(what: str, models: str | None, recipe: str | None) -> "AffinityMatrix":
    from perception.shelf.affinity import load_affinity
    from perception.shelf.language.stored import DEFAULT_MODELS, DEFAULT_RECIPE, stored_affinity

    if what.endswith(".json"):
        if models or recipe:
            raise InputError(f"{what}: --models and --recipe are for stored domains alone")
        return load_affinity(Path(what))
    return stored_affinity(what, models or DEFAULT_MODELS, recipe or DEFAULT_RECIPE)


def _check_writable(out: Path) -> None:
    if out.is_dir() or not out.parent.is_dir():
        raise InputError(f"--out {out}: cannot be written; expected a file in a folder that exists")


def _print_matrix(matrix: "AffinityMatrix", thing: str | None) -> None:
    table = Table(box=None, padding=(0, 3, 0, 0))
    if thing is None:
        table.add_column("object")
        table.add_column("goes with")
        for name in matrix.names:
            table.add_row(name, _best(matrix, name))
    else:
        table.add_column(f"beside {thing}")
        table.add_column("share", justify="right")
        for other, share in _sorted(matrix, thing):
            table.add_row(other, f"{share:.3f}")
    results().print(table)
    origin = matrix.origin
    words = [origin.model, origin.version, origin.date, origin.licence]
    chatter().print(" | ".join(word for word in words if word))


def _best(matrix: "AffinityMatrix", name: str) -> str:
    best = _sorted(matrix, name)[:NEIGHBOURS]
    return ", ".join(f"{other} {share:.2f}" for other, share in best)


def _sorted(matrix: "AffinityMatrix", name: str) -> list[tuple[str, float]]:
    row = matrix.row(name).tolist()
    pairs = [pair for pair in zip(matrix.names, row, strict=True) if pair[0] != name]
    return sorted(pairs, key=lambda pair: -pair[1])


def _document(matrix: "AffinityMatrix", thing: str | None) -> dict[str, object]:
    names = matrix.names if thing is None else (thing,)
    return {
        "model": matrix.origin.model,
        "prompt": matrix.origin.prompt,
        "version": matrix.origin.version,
        "date": matrix.origin.date,
        "licence": matrix.origin.licence,
        "affinities": {name: dict(_sorted(matrix, name)) for name in names},
    }

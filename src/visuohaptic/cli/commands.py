"""The sub-commands of `visuohaptic`."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from visuohaptic import __version__
from visuohaptic.cli import (
    DEBUG,
    compare,
    evaluate,
    explore,
    export,
    meshes,
    new,
    press,
    report,
    tables,
)
from visuohaptic.cli.printing import say
from visuohaptic.io.moved import COMMANDS


class _Commands(TyperGroup):
    """The sub-commands; a former name of a command or an option raises an error with its successor."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command that the first argument names."""
        name, *rest = args
        options = rest[: rest.index("--")] if "--" in rest else rest
        for option in ("", *(argument.partition("=")[0] for argument in options)):
            successor = COMMANDS.get(f"{name} {option}".strip())
            if successor and not ctx.resilient_parsing:
                former = f"option {option} of {name}" if option else f"command {name}"
                ctx.fail(f"there is no {former}: {successor}.")
        return super().resolve_command(ctx, args)


app = typer.Typer(
    cls=_Commands,
    help="Look at a 3D object, touch the places where the eye would fixate, and recognise the object only from touch.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
for command in (
    *(explore.touch, explore.recognise, press.press, new.new, evaluate.evaluate),
    *(report.report, compare.compare, export.export, tables.tables),
):
    app.command()(command)
app.add_typer(meshes.app, name="meshes")


DebugOption = Annotated[bool, typer.Option(DEBUG, help="Print the traceback of an error.")]


def _show_version(is_given: bool) -> None:  # noqa: FBT001 - typer calls the function so
    if is_given:
        say(f"visuohaptic {__version__}")
        raise typer.Exit


VersionOption = Annotated[
    bool, typer.Option("--version", help="Show the version.", callback=_show_version, is_eager=True)
]


@app.callback()
def _options(debug: DebugOption = False, version: VersionOption = False) -> None:  # noqa: FBT002
    """Declare the options before a sub-command; `main.run` reads `--debug`."""

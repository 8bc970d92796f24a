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
    press,
    report,
    tables,
)
from visuohaptic.cli.printing import say
from visuohaptic.io.moved import COMMANDS


class _Commands(TyperGroup):
    """The sub-commands; an old name of a command or an option is refused with where it is now."""

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Find the command that the first argument names."""
        name, *others = args
        options = others[: others.index("--")] if "--" in others else others
        for option in ("", *(one.partition("=")[0] for one in options)):
            where = COMMANDS.get(f"{name} {option}".strip())
            if where and not ctx.resilient_parsing:
                kind = f"option {option} of {name}" if option else f"command {name}"
                ctx.fail(f"there is no {kind}: {where}.")
        return super().resolve_command(ctx, args)


app = typer.Typer(
    cls=_Commands,
    help="Look at a 3D object, touch it where the eye would rest, and recognise it from touch alone.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
for command in (
    *(explore.touch, explore.recognise, press.press, evaluate.evaluate, report.report),
    *(compare.compare, export.export, tables.tables),
):
    app.command()(command)
app.add_typer(meshes.app, name="meshes")


DebugOption = Annotated[bool, typer.Option(DEBUG, help="Show where an error arose.")]


def _show_version(asked: bool) -> None:  # noqa: FBT001 - as typer calls it
    if asked:
        say(f"visuohaptic {__version__}")
        raise typer.Exit


VersionOption = Annotated[
    bool, typer.Option("--version", help="Show the version.", callback=_show_version, is_eager=True)
]


@app.callback()
def _options(debug: DebugOption = False, version: VersionOption = False) -> None:  # noqa: FBT002
    """Take the options that stand before a sub-command; `main` looks for `--debug` itself."""

"""`sgi completion`: the script that makes a shell complete commands, options and names of files."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class


@click.command(short_help="Print the script that completes commands in a shell.")
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def completion(shell: str) -> None:
    r"""Print what makes SHELL complete commands, options and names of files.

    \b
    bash:  sgi completion bash >> ~/.bashrc
    zsh:   sgi completion zsh >> ~/.zshrc        (after compinit)
    fish:  sgi completion fish > ~/.config/fish/completions/sgi.fish
    """
    found = get_completion_class(shell)
    assert found is not None
    group = click.get_current_context().find_root().command
    script = found(group, {}, "sgi", "_SGI_COMPLETE")
    click.echo((script.source_template % script.source_vars()).strip())

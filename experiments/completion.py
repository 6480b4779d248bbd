"""Completion of `imitate` in shells: a small script that knows every experiment and its options."""

from dataclasses import fields

from experiments.errors import ExperimentError
from experiments.registry import EXPERIMENTS
from models.errors import unknown

SHELLS = {"bash": "", "zsh": "autoload -U +X bashcompinit && bashcompinit\n"}
"""Shell -> what it is told before a script of bash's."""
GENERAL = ("list", "--help", "--version", "--completion")
SCRIPT = """{before}_imitate() {{
    local words=""
    if [ "$COMP_CWORD" -eq 1 ]; then words="{general}"; else case "${{COMP_WORDS[1]}}" in
{cases}
    esac; fi
    if [ "$COMP_CWORD" -gt 2 ] && [[ ${{COMP_WORDS[COMP_CWORD-1]}} == --* && ${{COMP_WORDS[COMP_CWORD]}} != -* ]]; then
        words=""
    fi
    COMPREPLY=($(compgen -W "$words" -- "${{COMP_WORDS[COMP_CWORD]}}"))
}}
complete -o default -F _imitate imitate
"""
"""Values of options are completed as files are."""


def script(shell: str) -> str:
    """Lines for `eval "$(imitate --completion bash)"` in a shell's start file.

    Raises:
        ExperimentError: another shell.
    """
    if shell not in SHELLS:
        raise ExperimentError(f"--completion: {unknown('shell', shell, SHELLS)}")
    cases = {name: " ".join(["--help", *flags(name)]) for name in EXPERIMENTS} | {"--completion": " ".join(SHELLS)}
    lines = "\n".join(f'        {name}) words="{words}" ;;' for name, words in cases.items())
    return SCRIPT.format(before=SHELLS[shell], general=" ".join([*EXPERIMENTS, *GENERAL]), cases=lines)


def flags(name: str) -> list[str]:
    """An experiment's options as they are written."""
    return [f"--{field.name.replace('_', '-')}" for field in fields(EXPERIMENTS[name].options())]

"""Markdown tables, and how they reach the terminal."""

from collections.abc import Iterable, Sequence

from rich.console import Console
from rich.markdown import Markdown


def table(rows: Iterable[Sequence[object]], header: Sequence[object] = ("what", "result")) -> str:
    """Rows of cells under a header."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def show(markdown: str) -> None:
    """Print for people."""
    Console().print(Markdown(markdown))

"""The commands that a page tells its reader to type: those of its blocks, and those within a line."""

import re
import shlex

PROGRAMS = ("dvc", "make", "snakemake", "visuohaptic")


def blocks(page, kind):
    """Return the text of each block of a kind, such as ``sh``."""
    return [
        text
        for found, text in re.findall(r"^```(\w+)\n(.*?)^```", page.read_text(), re.M | re.DOTALL)
        if found == kind
    ]


def block_commands(page):
    """Return the lines of a page's shell blocks, each as its words, without comments."""
    lines = [line for text in blocks(page, "sh") for line in text.splitlines()]
    return [words for line in lines if (words := shlex.split(line, comments=True))]


def line_commands(page):
    """Return the commands with arguments that stand within the page's lines, each once, as words."""
    prose = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.DOTALL)
    spans = re.findall(rf"`((?:{'|'.join(PROGRAMS)}) [^`]+)`", prose)
    return [shlex.split(text) for text in dict.fromkeys(spans)]

"""The style of HTML pages, and the policy that says which script may run."""

from __future__ import annotations

from base64 import b64encode
from hashlib import sha256
from importlib.resources import files


def content_policy(script: str) -> str:
    """Return a page's Content-Security-Policy: load nothing, and run only the script `script`."""
    digest = b64encode(sha256(script.encode("utf-8")).digest()).decode("ascii")
    return (
        f"default-src 'none'; base-uri 'none'; form-action 'none'; img-src data: blob:; "
        f"style-src 'unsafe-inline'; script-src 'sha256-{digest}'"
    )


def page_style() -> str:
    """Return the style of every page, with the colours of charts as variables."""
    return template_text("style.css")


def template_text(name: str) -> str:
    """Return the text of a file in `templates`."""
    return files("visuohaptic.pictures").joinpath("templates", name).read_text("utf-8")

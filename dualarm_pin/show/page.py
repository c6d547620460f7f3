"""Put a page together: meshcat's viewer, our scripts and styles and the data, all in one file."""

from __future__ import annotations

import html
import importlib.util
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from dualarm_pin.errors import MissingFileError
from dualarm_pin.show.packing import squeeze

_WEB = Path(__file__).with_name("web")
_PLAYER = [
    f"{part}.js" for part in "core robot marks nearest view stage chart player panel".split()
]


def render_page(
    title: str,
    data: bytes,
    *,
    body: str = "player.html",
    content: str | None = None,
    scripts: Sequence[str] = (),
    styles: Sequence[str] = (),
    live: bool = False,
) -> bytes:
    """Return a page that needs nothing but itself: no network, no server, no other file.

    Args:
        title: Title of the page, any text.
        data: What `Scene.pack` returned.
        body: Template of the page's body in `web/`.
        content: The body itself instead; an element with the id `player` holds the animation.
        scripts: Further scripts in `web/`, run after the player's.
        styles: Further style sheets in `web/`.
        live: It may ask the server that it came from.

    Raises:
        MissingFileError: meshcat is not installed whole.
    """
    parts = {
        "title": html.escape(title),
        "connect": "; connect-src 'self'" if live else "",
        "style": "\n".join(_read(name) for name in ("player.css", *styles)),
        "body": _read(body) if content is None else content,
        "viewer": _viewer(),
        "script": "\n".join(_read(name) for name in (*_PLAYER, *scripts, "start.js")),
        "data": squeeze(data),
    }
    # One pass from left to right: what is put in is never searched for places again.
    page = re.sub("{{(.*?)}}", lambda place: parts[place[1]], _read("page.html"))
    return page.encode("utf-8")


def render_text_page(title: str, content: str, *, styles: Sequence[str] = ()) -> bytes:
    """Return a page without an animation: a title, a body and style sheets of `web/`."""
    style = "\n".join(_read(name) for name in ("player.css", *styles))
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta http-equiv="Content-Security-Policy" '
        "content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:\">"
        f'<link rel="icon" href="data:,"><title>{html.escape(title)}</title>'
        f"<style>{style}</style></head><body>{content}</body></html>"
    ).encode()


@cache
def _viewer() -> str:
    # Found without importing meshcat, which would take half a second.
    found = importlib.util.find_spec("meshcat")
    folder = Path(found.origin).parent if found is not None and found.origin else Path("meshcat")
    file = folder / "viewer" / "dist" / "main.min.js"
    try:
        return squeeze(file.read_bytes())
    except OSError as error:
        raise MissingFileError(
            "the viewer of meshcat is missing: install meshcat 0.3.2 again", file=file
        ) from error


@cache
def _read(name: str) -> str:
    return (_WEB / name).read_text(encoding="utf-8")

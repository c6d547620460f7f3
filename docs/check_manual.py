"""Open every page of the built manual from disk: `python docs/check_manual.py build/manual`.

Ends with 1 where a page asks for anything outside the folder, complains, links to nothing, or where
the search finds nothing.
"""

import sys
from pathlib import Path

from make_pictures import open_browser


def main() -> None:
    """Open all pages."""
    site = Path(sys.argv[1]).resolve()
    wrong: list[str] = []
    pages = sorted(site.rglob("*.html"))
    with open_browser() as browser:
        for file in pages:
            page = browser.new_page()
            page.on("request", lambda r, f=file: wrong.extend(outside(r.url, site, f)))
            page.on("requestfailed", lambda r, f=file: wrong.append(f"{f.name}: no {r.url}"))
            page.on("pageerror", lambda e, f=file: wrong.append(f"{f.name}: {e}"))
            page.on("console", lambda m, f=file: wrong.extend(complaint(m.type, m.text, f)))
            page.goto(file.as_uri())
            for link in page.evaluate("[...document.querySelectorAll('a[href]')].map(a => a.href)"):
                target = link.partition("#")[0].partition("?")[0].removeprefix("file://")
                if link.startswith("file:") and not Path(target).is_file():
                    wrong.append(f"{file.name}: links to nothing: {link}")
            page.close()
        page = browser.new_page()
        page.goto(f"{(site / 'search.html').as_uri()}?q=clearance")
        page.wait_for_selector("ul.search li a", timeout=60_000)
        page.close()
    if wrong:
        sys.exit("\n".join(wrong))
    print(f"{len(pages)} pages open from disk, and the search finds")


def outside(url: str, site: Path, file: Path) -> list[str]:
    """Return a complaint about a request that leaves the folder."""
    inside = url.startswith((site.as_uri(), "data:", "blob:"))
    return [] if inside else [f"{file.name}: asks for {url:.120}"]


def complaint(kind: str, text: str, file: Path) -> list[str]:
    """Return what a page says to its console, if that is bad."""
    return [f"{file.name}: {text}"] if kind in ("error", "warning") else []


if __name__ == "__main__":
    main()

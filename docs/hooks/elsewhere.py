"""Files outside docs/ that its pages link to, for the site: pages that are written at the root, and copies of code.

On a forge a link such as `../CONTRIBUTING.md` or `../benchmarks/plan.py` leads to the file. The site has no such files,
so a document of the root is a page of its own here, any other file a page that shows it, and a folder is named without
a link.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
DOCUMENTS = ("CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md")
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#]+)(#[^)\s]*)?\)")
LANGUAGES = {".py": "python", ".toml": "toml", ".json": "json", ".yml": "yaml", ".sh": "sh", ".cpp": "cpp"}


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page per document of the root, and one per other file that a page links to."""
    pages = {page.src_uri: ROOT / "docs" / page.src_uri for page in files.documentation_pages()}
    for name in DOCUMENTS:
        pages[name.lower()] = ROOT / name
        files.append(File.generated(config, name.lower(), content=(ROOT / name).read_text(encoding="utf-8")))
    for path in sorted({target for page in pages.values() for target in _linked(page) if _is_shown_as_code(target)}):
        files.append(File.generated(config, _uri_of(path), content=_shown(path)))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Lead links out of docs/, and those of the documents of the root, to where the site has what they mean."""
    written = _written_at(page.file.src_uri)
    if written is None:
        return markdown

    def led(found: re.Match[str]) -> str:
        picture, text, link, anchor = found[1], found[2], found[3], found[4] or ""
        target = _target(written, link)
        if target is None or not target.exists():
            return found[0]  # MkDocs complains about those that are nowhere
        if target.is_dir():
            return text
        here = Path(page.file.src_uri).parent
        return f"{picture}[{text}]({Path(os.path.relpath(_uri_of(target), here)).as_posix()}{anchor})"

    return LINK.sub(led, markdown)


def _written_at(uri: str) -> Path | None:
    """Return the file that a page of the site was written in; None for pages that are made."""
    for path in (DOCS / uri, ROOT / uri.upper().replace(".MD", ".md")):
        if path.is_file():
            return path
    return None


def _linked(document: Path) -> Iterator[Path]:
    for found in LINK.finditer(document.read_text(encoding="utf-8")):
        target = _target(document, found[3])
        if target is not None:
            yield target


def _target(document: Path, link: str) -> Path | None:
    """Return the file of this project that a link leads to; None for addresses of other sites."""
    if re.match(r"[a-z]+:", link):
        return None
    target = (document.parent / link).resolve()
    return target if target.is_relative_to(ROOT) else None


def _is_shown_as_code(path: Path) -> bool:
    return path.is_file() and not path.is_relative_to(DOCS) and path.name not in DOCUMENTS


def _uri_of(path: Path) -> str:
    if path.is_relative_to(DOCS):
        return path.relative_to(DOCS).as_posix()
    if path.parent == ROOT and path.name in DOCUMENTS:
        return path.name.lower()
    return f"source/{path.relative_to(ROOT).as_posix().lstrip('.')}.md"  # hidden ones would be left out


def _shown(path: Path) -> str:
    name, text = path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8").rstrip()
    return f"# {name}\n\n````{LANGUAGES.get(path.suffix, 'text')}\n{text}\n````\n"

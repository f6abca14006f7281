"""Makes the book out of the repository: pages from outside docs/, the index of cases, and links to sources.

A page is known by its path in the repository and by its place in the book. Links are written for the code
host, relative to the file in the repository; here they are turned into links of the book. A link to a file
that is no page leads to a copy of it, so that the book needs no network.
"""

import posixpath
import re
from pathlib import Path

from mkdocs.structure.files import File, InclusionLevel

ROOT = Path(__file__).resolve().parents[3]
# Pages from outside docs/ and their places in the book.
OUTSIDE = {
    "ARCHITECTURE.md": "code/architecture.md",
    "CHANGELOG.md": "code/changelog.md",
    "SECURITY.md": "code/security.md",
}
# Pages that stand for others.
INSTEAD = {
    "README.md": "docs/index.md",
    "cases": "cases/index.md",
    "docs/decisions": "docs/decisions/README.md",
}
# Endings of files that are copied as they are; others are shown as text in a page.
COPIED = {".csv", ".svg", ".png", ".json", ".stl"}
# Largest file that is shown or copied [bytes].
LARGEST = 2_000_000
LINK = re.compile(r"\]\(([^)\s]+)\)")
# Languages by the ending of a file.
LANGUAGES = {".toml": "toml", ".rs": "rust", ".h": "c", ".c": "c", ".C": "cpp", ".py": "python", ".sh": "sh"}

# Pages that the search puts first: those that explain every key and every column.
FIRST_FOUND = {"scene.md": 4, "files.md": 3}

# Place in the book of each path of the repository that has one, and the other way round.
places = {}
paths = {}


def cases():
    """Folders of cases, in the order of their names."""
    return sorted(path.parent for path in (ROOT / "cases").glob("*/README.md"))


def title_of(text):
    return text.splitlines()[0].removeprefix("# ").strip()


def on_config(config):
    """Fills the parts of the navigation that are lists of files."""

    def filled(entries):
        for entry in entries:
            for title, value in entry.items() if isinstance(entry, dict) else []:
                if value == "cases":
                    entry[title] = ["cases/index.md"] + [
                        {case.name: f"cases/{case.name}/index.md"} for case in cases()
                    ]
                elif value == "decisions":
                    names = sorted(path.name for path in (ROOT / "docs/decisions").glob("*.md"))
                    entry[title] = ["decisions/README.md"] + [
                        f"decisions/{name}" for name in names if name != "README.md"
                    ]
                elif isinstance(value, list):
                    filled(value)

    filled(config.nav)
    return config


def on_files(files, config):
    """Adds pages and pictures from outside docs/, and what pages link to."""

    def add(path, place, content=None, inclusion=InclusionLevel.INCLUDED):
        if content is None:
            made = File.generated(config, place, abs_src_path=str(ROOT / path), inclusion=inclusion)
        else:
            made = File.generated(config, place, content=content, inclusion=inclusion)
        files.append(made)
        places[path], paths[place] = place, path

    for file in list(files):
        places[f"docs/{file.src_uri}"], paths[file.src_uri] = file.src_uri, f"docs/{file.src_uri}"
    for path, place in OUTSIDE.items():
        add(path, place)
    for case in cases():
        add(f"cases/{case.name}/README.md", f"cases/{case.name}/index.md")
        for picture in sorted([*case.glob("*.svg"), *case.glob("*.png")]):
            add(f"cases/{case.name}/{picture.name}", f"cases/{case.name}/{picture.name}")
        places[f"cases/{case.name}"] = f"cases/{case.name}/index.md"
    add("cases/index.md", "cases/index.md", index_of_cases())
    for path, other in INSTEAD.items():
        places[path] = places[other]

    pages = [path for path in paths.values() if path.endswith(".md") and (ROOT / path).is_file()]
    for page in pages:
        for path in linked((ROOT / page).read_text(), page):
            if path not in places and (ROOT / path).exists():
                add_source(add, path)
    return files


def add_source(add, path):
    """Adds a file or a folder that a page links to."""
    source = ROOT / path
    if source.is_dir():
        names = sorted(entry.name + ("/" if entry.is_dir() else "") for entry in source.iterdir())
        text = hidden(f"# {path}\n\nFiles of this folder of the repository:\n\n")
        for name in names:
            file = f"{path}/{name}"
            if name.endswith((".csv", ".json")) and (ROOT / file).stat().st_size < LARGEST:
                if file not in places:
                    add(file, f"source/{file}")
                text += f"* [{name}]({name})\n"
            else:
                text += f"* `{name}`\n"
        add(f"{path}/index.md", f"source/{path}/index.md", text, InclusionLevel.NOT_IN_NAV)
        places[path] = f"source/{path}/index.md"
    elif source.suffix in COPIED:
        add(path, f"source/{path}")
    else:
        text = source.read_text()
        fence = "`" * 6
        language = LANGUAGES.get(source.suffix, "text")
        page = hidden(f"# {path}\n\n{fence}{language}\n{text}\n{fence}\n")
        add(path, f"source/{path}.md", page, InclusionLevel.NOT_IN_NAV)


def hidden(text):
    """Page that the search leaves out."""
    return f"---\nsearch:\n  exclude: true\n---\n{text}"


def index_of_cases():
    """Page with a row for each case: what it asks, and which number it expects."""
    text = (
        "# Cases\n\nEach case asks one question that has a known number as its answer, and says where that\n"
        "number comes from. `cargo xtask test` runs each at a small size, but for `goldschmidt`, which\n"
        "`cargo xtask bench gas` runs.\n\n"
        "| case | question | expected |\n|---|---|---|\n"
    )
    for case in cases():
        page = (case / "README.md").read_text()
        text += f"| [{case.name}]({case.name}/README.md) | {title_of(page)} | {expected(page)} |\n"
    return text


def expected(page):
    """Sentence of a case's answer with the first number in bold; without one the first sentence."""
    _, _, answer = page.partition("**Expected:**")
    prose = [line for line in answer.splitlines() if not line.startswith(("|", "    ", "!"))]
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", " ".join(" ".join(prose).split()))
    sentences = re.split(r"(?<=[.])(?<!Phys\.)(?<!Rev\.)(?<!Lett\.)\s+(?=[A-Z*])", text)
    numbers = [sentence for sentence in sentences if re.search(r"\*\*[^*]*\d[^*]*\*\*", sentence)]
    sentence = (numbers or sentences)[0].replace("|", "\\|") or "see the case"
    return sentence[0].upper() + sentence[1:]


def linked(text, page):
    """Paths of the repository that a page links to."""
    for target in LINK.findall(text):
        target = target.split("#")[0]
        if target and "://" not in target and not target.startswith("mailto:"):
            yield resolved(page, target)


def resolved(page, target):
    return posixpath.normpath(posixpath.join(posixpath.dirname(page), target)).rstrip("/")


def on_page_markdown(markdown, page, config, files):
    """Turns links into those of the book."""
    here = page.file.src_uri
    if here in FIRST_FOUND:
        page.meta["search"] = {"boost": FIRST_FOUND[here]}
    path = paths.get(here, here)

    def turned(match):
        target, hash_, anchor = match.group(1).partition("#")
        if not target or "://" in target or target.startswith("mailto:"):
            return match.group(0)
        place = places.get(resolved(path, target))
        if place is None:
            return match.group(0)
        return f"]({posixpath.relpath(place, posixpath.dirname(here) or '.')}{hash_}{anchor})"

    return LINK.sub(turned, markdown)

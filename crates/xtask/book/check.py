"""Reads the whole book in a headless browser and says what is wrong with it.

    python check.py FOLDER CHROMIUM [--pictures FOLDER]

Every page is opened from a local server: links and anchors must lead somewhere, pictures must load, nothing
may be asked of another server, nothing may complain, and a phone must not have to scroll sideways. The search
must lead to the right pages. With --pictures some pages are photographed.
"""

import functools
import http.server
import sys
import threading
from pathlib import Path
from urllib.parse import unquote, urljoin, urlsplit

from playwright.sync_api import sync_playwright

# What a reader looks for, and the page that must be among the first answers.
SEARCHES = {
    "work_function_eV": "scene.html",
    "Shockley": "questions.html",
    "exit code": "errors.html",
    "charge_histogram": "files.html",
    "Madelung": "cases/madelung/index.html",
    "blockMesh": "openfoam.html",
    "on_exit": "scene.html",
}
# Number of answers among which it must be.
FIRST = 5
DESK = {"width": 1280, "height": 900}
PHONE = {"width": 390, "height": 844}
# Pages that are photographed on a desk and on a phone.
PHOTOGRAPHED = [
    "index.html",
    "start.html",
    "scene.html",
    "files.html",
    "equations.html",
    "validation.html",
    "cases/index.html",
    "cases/two-materials/index.html",
    "reports/speed.html",
    "errors.html",
    "questions.html",
]
# What a page holds, read in the browser.
LOOK = """() => ({
    links: [...document.querySelectorAll('a[href]')].map(a => a.getAttribute('href')),
    ids: [...document.querySelectorAll('[id]')].map(e => e.id),
    blank: [...document.images].filter(i => !(i.complete && i.naturalWidth > 0)).map(i => i.src),
    title: document.querySelector('h1')?.textContent ?? '',
})"""
TOO_WIDE = """() => document.documentElement.scrollWidth - document.documentElement.clientWidth"""


class Handler(http.server.SimpleHTTPRequestHandler):
    # Connections are kept, as a browser asks for many files at once.
    protocol_version = "HTTP/1.1"

    def log_message(self, *arguments):
        pass


class Server(http.server.ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 128


def serve(folder):
    handler = functools.partial(Handler, directory=str(folder))
    server = Server(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/"


def read_pages(page, home, names, problems):
    """Opens every page; returns the anchors of each and the links of each."""
    anchors, links = {}, {}
    for name in names:
        page.goto(home + name, wait_until="load")
        found = page.evaluate(LOOK)
        anchors[name] = set(found["ids"])
        links[name] = set(found["links"])
        problems += [f"{name}: the picture {picture} does not load" for picture in found["blank"]]
        if not found["title"]:
            problems.append(f"{name}: there is no headline")
        page.set_viewport_size(PHONE)
        if (wide := page.evaluate(TOO_WIDE)) > 0:
            problems.append(f"{name}: a phone scrolls sideways by {wide} pixels")
        page.set_viewport_size(DESK)
    return anchors, links


def check_links(home, folder, anchors, links, problems):
    for name, targets in links.items():
        for target in targets:
            address = urlsplit(urljoin(home + name, target))
            if f"{address.scheme}://{address.netloc}/" != home:
                continue
            path = unquote(address.path).lstrip("/") or "index.html"
            path += "index.html" if path.endswith("/") else ""
            anchor = unquote(address.fragment)
            if not (folder / path).is_file():
                problems.append(f"{name}: the link {target} leads nowhere")
            elif anchor and path in anchors and anchor not in anchors[path]:
                problems.append(f"{name}: the link {target} leads to a place that {path} does not have")


def check_search(page, home, problems):
    for words, wanted in SEARCHES.items():
        page.goto(home, wait_until="load")
        page.keyboard.press("/")
        page.keyboard.type(words)
        if not (found := answers(page, wanted)):
            problems.append(f"the search for {words} finds nothing")
        elif not any(path.endswith(wanted) for path in found):
            problems.append(f"the search for {words} leads to {found} and not to {wanted}")


def answers(page, wanted):
    """Pages of the first answers; they change for a while after words are typed."""
    results = page.locator(".md-search-result__item > a.md-search-result__link")
    found = []
    for _ in range(50):
        found = results.evaluate_all("links => links.map(link => new URL(link.href).pathname)")[:FIRST]
        if any(path.endswith(wanted) for path in found):
            break
        page.wait_for_timeout(100)
    return found


def photograph(browser, home, into):
    into.mkdir(parents=True, exist_ok=True)
    for size, viewport in (("desk", DESK), ("phone", PHONE)):
        page = browser.new_page(viewport=viewport)
        for name in PHOTOGRAPHED:
            page.goto(home + name, wait_until="load")
            page.screenshot(path=into / f"{name.replace('/', '-')}-{size}.png")
        page.close()


def main():
    folder, chromium, *more = sys.argv[1:]
    folder = Path(folder).resolve()
    home = serve(folder)
    problems = []
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_page(viewport=DESK)
        asked = []
        page.on("request", lambda request: asked.append(request.url))
        page.on("console", lambda line: line.type == "error" and problems.append(f"{page.url}: {line.text}"))
        page.on("pageerror", lambda error: problems.append(f"{page.url}: {error}"))
        names = sorted(str(path.relative_to(folder)) for path in folder.rglob("*.html"))
        names.remove("404.html")
        anchors, links = read_pages(page, home, names, problems)
        check_links(home, folder, anchors, links, problems)
        check_search(page, home, problems)
        outside = {url for url in asked if not url.startswith((home, "data:", "blob:"))}
        problems += [f"something is asked of {url}" for url in sorted(outside)]
        if more[:1] == ["--pictures"]:
            photograph(browser, home, Path(more[1]))
        browser.close()
    for problem in problems:
        print(f"error: {problem}")
    counted = f"{len(names)} pages, {sum(map(len, links.values()))} links, {len(SEARCHES)} searches"
    print(f"{counted}: {len(problems)} problems")
    sys.exit(1 if problems else 0)


main()

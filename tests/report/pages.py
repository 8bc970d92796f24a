"""Reads a page the way a strict reader would."""

from dataclasses import dataclass, field
from html.parser import HTMLParser

VOID = {"br", "hr", "img", "input", "link", "meta"}


@dataclass
class Element:
    """A start tag: its name, its attributes, and the tags around it."""

    name: str
    attributes: dict
    around: tuple = ()


@dataclass
class Page:
    """All start tags in order, and all texts outside scripts and styles."""

    elements: list = field(default_factory=list)
    texts: list = field(default_factory=list)

    def named(self, *names):
        return [element for element in self.elements if element.name in names]

    def values(self, attribute):
        return [e.attributes[attribute] for e in self.elements if attribute in e.attributes]

    @property
    def objects(self):
        """Names of the objects that are shown."""
        return [article.attributes["data-name"] for article in self.named("article")]

    @property
    def text(self):
        return " ".join(" ".join(self.texts).split())


class _Reader(HTMLParser):
    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.page = Page()
        self.open = []

    def handle_starttag(self, tag, attrs):
        element = Element(tag, dict(attrs), tuple(self.open))
        self.page.elements.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop().name == tag, (tag, self.getpos())

    def handle_data(self, data):
        if not self.open or self.open[-1].name not in {"script", "style"}:
            self.page.texts.append(data)


def plain(text):
    """Return a text with breaks allowed at its blanks, as a test writes it."""
    return text.replace("\N{NO-BREAK SPACE}", " ")


def read_page(text):
    """Read a page, of which every tag must be closed where it was opened."""
    reader = _Reader()
    reader.feed(text)
    reader.close()
    assert reader.open == []
    return reader.page

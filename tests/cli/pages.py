"""A page as a reader and a browser take it: its texts, its tables, and what it would load."""

from html.parser import HTMLParser

LOADING = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src", "object": "data"}


class Page(HTMLParser):
    """`cells` are the texts of the tables' cells, `said` those of the notes; `loads` is what tags would load."""

    def __init__(self, text):
        super().__init__()
        self.cells, self.said, self.headings, self.loads, self.frames = [], [], [], [], []
        self.tags, self._open = [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        known = dict(attributes)
        self.tags.append(tag)
        if LOADING.get(tag) in known:
            self.loads.append(known[LOADING[tag]])
        if "srcdoc" in known:
            self.frames.append(Page(known["srcdoc"]))
        if tag in ("td", "th"):
            self._open.append(self.cells)
        elif "said" in (known.get("class") or "").split():
            self._open.append(self.said)
        elif tag in ("h1", "h2", "title"):
            self._open.append(self.headings)
        else:
            return
        self._open[-1].append("")

    def handle_endtag(self, tag):
        if tag in ("td", "th", "p", "h1", "h2", "title") and self._open:
            self._open.pop()

    def handle_data(self, data):
        if self._open:
            self._open[-1][-1] += data

    def beside(self, name):
        """Return the text of the cell behind the one with a name."""
        return self.cells[self.cells.index(name) + 1]

"""`pockmark report`: a page of a run, of several, or of a campaign, to read without pockmark and without a network."""

from pathlib import Path
from typing import Annotated

import typer

from .. import __version__
from ..base.errors import PockmarkError
from ..base.files import make_folder, write_text
from ..base.terminal import literal
from ..run.beside import comparison
from ..run.provenance import now
from ..run.reported import run_report
from ..run.store import MANIFEST
from ..study.reported import campaign_report, table_in
from ..view.page import campaign_page, comparison_page, require_jinja, run_page
from .common import CONSOLE, say_written

PAGE = "report.html"


def report(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="DIR...", help="A run folder, several, or the folder of a campaign."),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help=f"The page ({PAGE} in the folder; of several runs: here)."),
    ] = None,
) -> None:
    """Write one HTML page of a run, of several runs side by side, or of a campaign. It needs no network."""
    require_jinja()  # before a minute of work
    if output and output.is_dir():
        raise PockmarkError(f"-o: {output}: is a folder, expected the file of the page, as {output / PAGE}")
    made_by = f"made by pockmark {__version__}, {now()}"
    is_run = [(folder / MANIFEST).exists() for folder in folders]
    tables = [None if run else table_in(folder) for folder, run in zip(folders, is_run, strict=True)]
    for folder, run, table in zip(folders, is_run, tables, strict=True):
        if table is None and folder.is_dir() and not run:
            raise PockmarkError(
                f"{folder}: is neither a run folder (it has no {MANIFEST}) nor that of a campaign (it has no results.csv)"
            )
        if table is not None and len(folders) > 1:
            raise PockmarkError(f"{folder}: is a campaign's, which has a page of its own: give it alone")
    if len(folders) > 1:
        page, place = comparison_page(comparison(folders), made_by), Path(PAGE)
    elif tables[0] is not None:
        page, place = campaign_page(campaign_report(tables[0]), made_by), tables[0].parent / PAGE
    else:
        gathered = run_report(folders[0])
        page, place = run_page(gathered, made_by), folders[0] / PAGE
        for text in [*gathered.cautions, *gathered.doubts]:
            CONSOLE.print(literal(f"doubtful: {text}", "bold red"))
        if gathered.view is None:
            CONSOLE.print(literal(f"no view in three dimensions: {gathered.no_view}", "yellow"))
    _write(page, output or place)


def _write(page: str, path: Path) -> None:
    """Write a page, and say where. Raises PockmarkError."""
    make_folder(path.parent)
    write_text(path, page)
    say_written(path, f" ({len(page.encode()) / 1e6:.1f} MB)")

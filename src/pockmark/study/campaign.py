"""A campaign: one scene with swept keys, in groups from which figures and tables are drawn."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError

from ..base.errors import PockmarkError
from ..base.files import as_path
from ..base.toml import read_toml, to_toml
from ..scene.model import Model
from ..scene.scene import Scene
from ..scene.sentences import sentence
from .slurm import Slurm

FILE = "campaign.toml"
Changes = Annotated[dict[str, Any], Field(default_factory=dict)]  # "impact.speed": "4 km/s"
Sweep = Annotated[dict[str, Annotated[list[Any], Field(min_length=1)]], Field(default_factory=dict)]


class Group(Model):
    """Runs for some figures: one for every combination of the swept values."""

    name: str
    figures: Annotated[list[str], Field(default_factory=list)]
    set: Changes
    sweep: Sweep
    quick: Sweep  # what is swept instead in the quick form


class Campaign(Model):
    """The tables of `campaign.toml`.

    `scene` and `report` are paths from the file's folder. `report` is a Python script that draws figures from the
    finished table; it is called as `report TABLE RUNS OUT`. `based_on` is the folder of another campaign, which this
    one repeats, with changes of its own.
    """

    title: str = ""
    based_on: str = ""
    scene: str
    report: str = ""
    coarse: Annotated[bool, Field(strict=True)] = False  # allows fewer than four cells across a projectile
    set: Changes
    quick: Changes
    slurm: Slurm | None = None  # for --slurm
    group: Annotated[list[Group], Field(min_length=1)]


@dataclass
class Case:
    """A run of a campaign: its scene, the swept values that made it, and the groups that want it."""

    scene: Scene
    swept: dict[str, Any]
    groups: list[str]

    @property
    def label(self) -> str:
        """Return the run's name for the terminal: the first group that wants it, and the swept values."""
        return ", ".join(
            [self.groups[0], *(f"{key.rpartition('.')[2]} {value}" for key, value in self.swept.items())]
        )


def load(folder: Path) -> Campaign:
    """Read a campaign. Raises PockmarkError with one sentence."""
    path = folder / FILE
    table = read_toml(path)
    if isinstance(base := table.get("based_on"), str):
        table = _repeated(table, as_path(folder / base))
    try:
        campaign = Campaign.model_validate(table)
    except ValidationError as error:
        raise PockmarkError(f"{path}: {sentence(error, Campaign)}") from None
    as_path(folder / campaign.report)  # said before anything runs
    return campaign


def _repeated(table: Mapping[str, Any], base: Path) -> dict[str, Any]:
    """Return a campaign's table with what it leaves to the campaign in the folder `base`, whose `set` it adds to.

    Raises PockmarkError for one that is at fault, or is based on a third one.
    """
    other = read_toml(base / FILE)
    if "based_on" in other:
        raise PockmarkError(f"{base / FILE}: based_on: expected a campaign that is not based on another one")
    load(base)
    for key in {"scene", "report"} & other.keys():
        other[key] = str((base / other[key]).resolve())
    repeated = {**other, **table}
    if isinstance(own := table.get("set", {}), Mapping):
        repeated["set"] = {**other.get("set", {}), **own}
    return repeated


def cases(campaign: Campaign, folder: Path, *, quick: bool, only: list[str]) -> list[Case]:
    """Return the runs of a campaign, each once, with all groups that want it.

    `only` names the groups or figures to run; an empty list means all. Raises PockmarkError for an unknown name.
    """
    known = {name for g in campaign.group for name in (g.name, *g.figures)}
    if unknown := sorted(set(only) - known):
        raise PockmarkError(
            f"--only {unknown[0]}: no such group or figure, allowed are {', '.join(sorted(known))}"
        )
    found: dict[str, Case] = {}
    wanted: set[str] = set()
    path = folder / campaign.scene
    base = read_toml(path)
    for group in campaign.group:
        is_wanted = not only or bool(set(only) & {group.name, *group.figures})
        sweep = group.quick if quick and group.quick else group.sweep
        for values in itertools.product(*sweep.values()):
            swept = dict(zip(sweep, values, strict=True))
            changes = campaign.set | group.set | (campaign.quick if quick else {}) | swept
            scene = Scene.from_dict(base, source=str(path), overrides=_texts(changes))
            found.setdefault(scene.hash, Case(scene, swept, [])).groups.append(group.name)
            if is_wanted:
                wanted.add(scene.hash)
    return [case for key, case in found.items() if key in wanted]


def _texts(changes: Mapping[str, Any]) -> list[str]:
    """Return the changes as texts that --set takes."""
    return [f"{key}={to_toml({'v': value}).removeprefix('v = ').strip()}" for key, value in changes.items()]

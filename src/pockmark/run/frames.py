"""The history of a run as a DataFrame of pandas."""

from typing import TYPE_CHECKING, Any

from ..base.errors import PockmarkError
from ..base.files import AnyPath
from ..base.ledger import LEDGER
from .history import OWN_UNITS, unit_of
from .store import RunFolder

if TYPE_CHECKING:
    from pandas import DataFrame


def history_frame(path: AnyPath) -> "DataFrame":
    """Return history.csv of a run folder, a row for each time, SI; `attrs["units"]` has the unit of each column.

    A torn last row of a run that was killed is left out. Raises PockmarkError, also where pandas is missing.
    """
    columns = RunFolder.open(path).history()
    frame: DataFrame = pandas().DataFrame(columns)
    counted = [name for name in columns if name not in LEDGER and name not in (*OWN_UNITS, "max_compression")]
    frame = frame.astype(dict.fromkeys(counted, "int64"))
    frame.attrs["units"] = {name: unit_of(name) for name in columns}
    return frame


def pandas() -> Any:
    """Return the module pandas. Raises PockmarkError where it is missing."""
    try:
        import pandas as module
    except ImportError:
        raise PockmarkError("pandas is not installed: pip install 'pockmark[pandas]'") from None
    return module

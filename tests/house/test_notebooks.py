"""The notebooks of examples/ run from their first cell to their last, and draw and print what they say."""

from pathlib import Path

import nbclient
import nbformat
import pytest

NOTEBOOK = Path(__file__).parents[2] / "examples" / "first-crater.ipynb"


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """The outputs of the cells of code, in their order."""
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    folder = tmp_path_factory.mktemp("notebook")
    client = nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3")
    client.execute(cwd=str(folder))
    assert not list(folder.iterdir()), "it is to run in memory"
    return [cell.outputs for cell in notebook.cells if cell.cell_type == "code"]


def text_of(cell):
    return "".join(output.text for output in cell if output.output_type == "stream")


def test_it_warns_of_what_memory_does_not_know_and_measures_a_crater(outputs):
    assert "warning" not in text_of(outputs[1])
    warnings, *lengths = text_of(outputs[3]).splitlines()
    assert warnings.startswith("['whether the depth has settled is not known")
    assert warnings.endswith("] []")
    assert warnings.count("', '") == 0
    depth, diameter, rim = (float(line.split()[1]) for line in lengths)
    print(f"C_p {depth} um, D_c {diameter} um, rim {rim} um")
    assert 10 < depth < 25 < diameter < 60


def test_it_draws(outputs):
    drawn = [output for cell in outputs for output in cell if "image/png" in output.get("data", {})]
    assert len(drawn) == 2
    assert all(len(output.data["image/png"]) > 5000 for output in drawn)


def test_a_faster_ball_makes_a_deeper_crater(outputs):
    depths = [float(word.strip("[]', um\n")) for word in text_of(outputs[-1]).split(",")]
    print(depths)
    assert depths == sorted(depths)
    assert depths[-1] > 1.5 * depths[0]


def test_it_is_kept_without_outputs():
    """Outputs would grow old, and be large."""
    cells = nbformat.read(NOTEBOOK, as_version=4).cells
    assert all(
        not cell.outputs and cell.execution_count is None for cell in cells if cell.cell_type == "code"
    )

"""A folder that is to be made where something else is."""

import pytest

from pockmark import PockmarkError
from pockmark.base.files import make_folder


@pytest.mark.parametrize("inside", ["", "runs/a"])
def test_a_file_in_the_place_of_a_folder_is_told(inside, tmp_path):
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(PockmarkError, match=r"file: is a file, expected a folder$"):
        make_folder(file / inside)


def test_a_folder_that_is_there_stays(tmp_path):
    (tmp_path / "one").write_text("1")
    make_folder(tmp_path)
    make_folder(tmp_path / "a" / "b")
    assert (tmp_path / "one").read_text() == "1"
    assert (tmp_path / "a" / "b").is_dir()

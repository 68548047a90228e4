import os
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.errors import WorldError
from explore_bt.maps import read_map, write_map
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

GOOD = """\
image: map.png
resolution: 0.05
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def save(folder: Path, text: str = GOOD, pixels: np.ndarray | None = None) -> Path:
    greys = np.array([[0, 205, 254]], dtype=np.uint8) if pixels is None else pixels
    cv2.imwrite(str(folder / "map.png"), greys)
    (folder / "map.yaml").write_text(text)
    return folder / "map.yaml"


def refusal(path: Path) -> str:
    with pytest.raises(WorldError) as caught:
        read_map(path)
    return str(caught.value).replace(str(path.parent) + os.sep, "")


@settings(deadline=None, max_examples=40)
@given(data=st.data())
def test_what_was_written_is_read_back(data: st.DataObject, tmp_path_factory: pytest.TempPathFactory) -> None:
    rows, cols = data.draw(st.integers(1, 12)), data.draw(st.integers(1, 12))
    values = data.draw(
        st.lists(st.sampled_from([FREE, OCCUPIED, UNKNOWN]), min_size=rows * cols, max_size=rows * cols)
    )
    coordinate = st.floats(-1e3, 1e3, allow_nan=False)
    grid = OccupancyGrid(
        np.array(values, dtype=np.int8).reshape(rows, cols),
        data.draw(st.floats(0.001, 10.0)),
        (data.draw(coordinate), data.draw(coordinate)),
    )
    picture, header = write_map(grid, tmp_path_factory.mktemp("map"), "flat")
    assert (picture.name, header.name) == ("flat.pgm", "flat.yaml")
    again = read_map(header)
    assert np.array_equal(again.cells, grid.cells)
    assert (again.resolution_m, again.origin_xy) == (grid.resolution_m, grid.origin_xy)


def test_written_pictures_carry_the_greys_of_map_saver(tmp_path: Path) -> None:
    grid = OccupancyGrid(np.array([[FREE, OCCUPIED], [UNKNOWN, FREE]], dtype=np.int8), 0.05, (0.0, 0.0))
    picture, _ = write_map(grid, tmp_path)
    data = picture.read_bytes()
    assert data.startswith(b"P5\n# CREATOR")
    assert list(data[-4:]) == [205, 254, 254, 0]  # the top row of the picture is the highest y


def test_thresholds_decide_between_free_unknown_and_occupied(tmp_path: Path) -> None:
    assert read_map(save(tmp_path)).cells.tolist() == [[OCCUPIED, UNKNOWN, FREE]]


def test_negate_swaps_black_and_white(tmp_path: Path) -> None:
    grid = read_map(save(tmp_path, GOOD.replace("negate: 0", "negate: 1")))
    assert grid.cells.tolist() == [[FREE, OCCUPIED, OCCUPIED]]


def test_the_lowest_row_of_the_picture_is_row_zero(tmp_path: Path) -> None:
    grid = read_map(save(tmp_path, pixels=np.array([[0], [254]], dtype=np.uint8)))
    assert grid.cells.tolist() == [[FREE], [OCCUPIED]]
    assert grid.center_of(0, 0) == pytest.approx((-0.975, 2.025))


def test_colour_and_sixteen_bit_pictures_are_read(tmp_path: Path) -> None:
    colour = np.repeat(np.array([[0, 254]], dtype=np.uint8)[:, :, None], 3, axis=2)
    assert read_map(save(tmp_path, pixels=colour)).cells.tolist() == [[OCCUPIED, FREE]]
    deep = np.array([[0, 65000]], dtype=np.uint16)
    assert read_map(save(tmp_path, pixels=deep)).cells.tolist() == [[OCCUPIED, FREE]]


def test_keys_of_other_tools_and_mode_trinary_are_accepted(tmp_path: Path) -> None:
    assert read_map(save(tmp_path, GOOD + "mode: trinary\nauthor: me\n")).shape == (1, 3)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        (
            "resolution: 0.05",
            "resolution: 0",
            "map.yaml:2:13  resolution is 0 m; expected metres per",
        ),
        (
            "resolution: 0.05",
            "resolution: wide",
            "map.yaml:2:13  resolution: wide is not a length; write",
        ),
        (
            "resolution: 0.05\n",
            "",
            "map.yaml:1:1  a map_server map lacks 'resolution'; add a line",
        ),
        ("resolution:", "resolutoin:", "lacks 'resolution'; 'resolutoin' may be a slip of the pen"),
        ("[-1.0, 2.0, 0.0]", "[-1.0, 2.0]", "map.yaml:3:9  found 2 values; expected [x, y, heading]"),
        ("2.0, 0.0]", "2.0, 0.5]", "map.yaml:3:9  the map is turned by 0.5 rad; only yaw 0 is read"),
        ("negate: 0", "negate: maybe", "map.yaml:4:9  negate is maybe; expected 0 or 1"),
        ("0.65", "1.65", "map.yaml:5:18  occupied_thresh is 1.65 of 1; expected 0 to 1 of 1"),
        ("0.196", "0.7", "map.yaml:6:14  free_thresh 0.7 lies above occupied_thresh 0.65"),
        ("negate: 0", "negate: 0\nmode: scale", "map.yaml:5:7  mode is scale; only trinary maps are read"),
        ("negate: 0", "negate: [", "is not YAML"),
        ("image: map.png", "image: gone.png", "its image gone.png does not exist; put it there or correct"),
        ("image: map.png", "image: .", "cannot be read"),
        ("image: map.png", "image: map.yaml", "map.yaml: is not a picture that can be read"),
    ],
)
def test_a_faulty_header_is_refused_with_its_place(
    before: str, after: str, message: str, tmp_path: Path
) -> None:
    assert message in refusal(save(tmp_path, GOOD.replace(before, after)))


def test_all_faults_of_a_header_come_at_once(tmp_path: Path) -> None:
    text = refusal(save(tmp_path, GOOD.replace("0.05", "-1").replace("negate: 0", "negate: 7")))
    assert len(text.splitlines()) == 2


def test_missing_empty_and_strange_files_are_refused(tmp_path: Path) -> None:
    assert "no such file" in refusal(tmp_path / "nowhere.yaml")
    (tmp_path / "empty.yaml").write_text("")
    assert refusal(tmp_path / "empty.yaml").startswith("empty.yaml:1:1  is empty; expected a map_server map")
    (tmp_path / "list.yaml").write_text("- 1\n")
    assert "holds a list" in refusal(tmp_path / "list.yaml")
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00\x80")
    assert "is no text (byte 0 is not UTF-8); give the YAML file of" in refusal(tmp_path / "binary.yaml")
    assert "cannot be read (is a directory)" in refusal(tmp_path)
    header = save(tmp_path)
    (tmp_path / "map.png").write_bytes(b"")
    assert "map.png: is not a picture that can be read (0 bytes)" in refusal(header)


def test_a_broken_picture_is_refused_once_and_in_our_words_only(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    header = save(tmp_path)
    (tmp_path / "map.png").write_bytes(b"P5\n100 80\n255\n\xfe")
    assert "is not a picture that can be read (15 bytes)" in refusal(header)
    assert capfd.readouterr() == ("", "")

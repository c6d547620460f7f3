"""Paths from CSV, G-code and APT files: what they mean, and what is refused with its line."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.path import Path, files, paths
from dualarm_pin.path.resample import resample

HEAD = "x,y,z,qw,qx,qy,qz\n"
HALF = math.sqrt(0.5)


@pytest.fixture
def write(tmp_path):
    def write(text, name="part.txt"):
        file = tmp_path / name
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        return file

    return write


# CSV -----------------------------------------------------------------------------------------


def test_csv_poses_and_directions(write):
    file = write(
        "x,y,z,qw,qx,qy,qz,ux,uy,uz,uwx,uwy,uwz\n"
        "# a comment\n"
        "0,0,.3, 1,0,0,0, 0,0,1,0,0,0\n"
        "\n"
        f"0.1,0,.3, {HALF},0,0,{HALF}, 0,0,1,0,0,2\n"
    )
    path = files.read_csv(file)
    assert path.name == "part"
    np.testing.assert_allclose(path.position, [[0, 0, 0.3], [0.1, 0, 0.3]])
    np.testing.assert_allclose(path.rotation[1], pin.rpy.rpyToMatrix(0, 0, math.pi / 2), atol=1e-12)
    np.testing.assert_array_equal(path.u, [[0, 0, 1, 0, 0, 0], [0, 0, 1, 0, 0, 2]])
    np.testing.assert_allclose(path.tangent, [[1, 0, 0]] * 2)


def test_csv_written_from_a_path_reads_back(write):
    path = paths.dome_spiral(0.15, points=61)
    rows = []
    for i in range(path.h):
        q = pin.Quaternion(path.rotation[i])
        rows.append([*path.position[i], q.w, q.x, q.y, q.z, *path.u[i, :3]])
    text = "\n".join(",".join(repr(float(v)) for v in row) for row in rows)
    back = files.read_csv(write(HEAD.strip() + ",ux,uy,uz\n" + text))
    np.testing.assert_allclose(back.position, path.position, atol=1e-15)
    np.testing.assert_allclose(back.rotation, path.rotation, atol=1e-12)
    np.testing.assert_allclose(back.u, path.u, atol=1e-15)
    # The tangent comes from differences of coarse points; at the inner end they say little.
    cosine = np.sum(back.tangent * path.tangent, axis=1)
    assert np.degrees(np.arccos(cosine[3:])).max() < 2


def test_csv_rounded_quaternions_are_normalised(write):
    file = write(HEAD + "0,0,0,0.7071,0,0,0.7071\n1,0,0,-0.7071,0,0,-0.7071\n")
    R = files.read_csv(file).rotation
    np.testing.assert_allclose(R[0] @ R[0].T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(R[0], R[1])


def test_csv_resampled_by_lines(write):
    file = write(HEAD + f"0,0,0,1,0,0,0\n1,0,0,1,0,0,0\n1,1,0,{HALF},0,0,{HALF}\n")
    path = files.read_csv(file, points=9)
    np.testing.assert_allclose(path.arc_length, np.linspace(0, 2, 9))
    np.testing.assert_allclose(path.position[6], [1, 0.5, 0], atol=1e-12)
    np.testing.assert_allclose(path.rotation[6], pin.rpy.rpyToMatrix(0, 0, math.pi / 4), atol=1e-9)
    np.testing.assert_allclose(path.tangent[4], [HALF, HALF, 0], atol=1e-12)


def test_csv_smooth_follows_the_curve_that_the_points_came_from(write):
    a = np.linspace(0, math.pi, 25)
    text = "x,y,z\n" + "\n".join(f"{math.cos(t)},{math.sin(t)},0.3" for t in a)
    file = write(text)
    for how in ({}, {"points": 97}, {"step": 0.05}):
        path = files.read_csv(file, smooth=True, **how)
        np.testing.assert_allclose(np.hypot(*path.position[:, :2].T), 1.0, atol=1e-5)
        exact = np.column_stack([-path.position[:, 1], path.position[:, 0], np.zeros(path.h)])
        np.testing.assert_allclose(path.tangent, exact, atol=1e-3)
        assert path.length == pytest.approx(math.pi, rel=1e-5)


def test_csv_u_between_points(write):
    file = write("x,y,z,ux,uy,uz\n0,0,0,1,0,0\n1,0,0,0,0,1\n")
    path = files.read_csv(file, points=3)
    np.testing.assert_allclose(path.u[1], [0.5, 0, 0.5, 0, 0, 0])


def test_csv_without_rotation_takes_the_given_one(write):
    file = write("x,y,z\n0,0,0\n0,1,0\n")
    path = files.read_csv(file, rotation=np.eye(3), orientation="tangent")
    np.testing.assert_allclose(path.rotation[0][:, 0], [0, 1, 0])
    np.testing.assert_allclose(path.rotation[0][:, 2], [0, 0, 1])


def test_csv_frame_moves_poses_and_directions(write):
    file = write(HEAD.strip() + ",ux,uy,uz\n0,0,0,1,0,0,0,0,0,1\n1,0,0,1,0,0,0,0,0,1\n")
    frame = pin.SE3(pin.rpy.rpyToMatrix(math.pi / 2, 0, 0), np.array([1.0, 2.0, 3.0]))
    path = files.read_csv(file, frame=frame)
    assert path.pose(0).isApprox(frame)
    np.testing.assert_allclose(path.u[0], [0, -1, 0, 0, 0, 0], atol=1e-12)


P = "0,0,0,1,0,0,0\n"
CSV_REFUSED = [
    ("", r"part.txt: the file is empty: a header is expected, such as x,y,z,qw"),
    ("\n\n# only this\n", "the file is empty"),
    (HEAD, r"part.txt: a path needs 2 points or more; given 0"),
    (HEAD + P, r"part.txt:2: a path needs 2 points or more; given 1"),
    ("x,y,zz\n", r"part.txt:1: unknown column 'zz': did you mean 'z'"),
    ("x;y;z\n0;0;0\n", r"part.txt:1: unknown column 'x;y;z': .*separated by commas"),
    ("x,y,y\n", "part.txt:1: the column y is given twice"),
    ("x,y,qw,qx,qy,qz\n", "part.txt:1: missing column z: x, y, z belong together"),
    ("x,y,z,qw,qx,qy\n", "part.txt:1: missing column qz"),
    ("x,y,z,ux,uy\n", "part.txt:1: missing column uz"),
    ("x,y,z,uwx,uwy,uwz\n", "part.txt:1: missing column ux, uy, uz: uwx"),
    (HEAD + P + "1,0,0,1,0,0\n", "part.txt:3: 7 values are expected, as in the header; given 6"),
    (HEAD + P + "1,a,0,1,0,0,0\n", "part.txt:3: y: a finite number is expected; given 'a'"),
    (HEAD + P + "1,nan,0,1,0,0,0\n", "part.txt:3: y: a finite number is expected; given 'nan'"),
    (HEAD + P + "1,0,-inf,1,0,0,0\n", "part.txt:3: z: a finite number .* given '-inf'"),
    (HEAD + P + "1,0,,1,0,0,0\n", "part.txt:3: z: a finite number .* given ''"),
    (HEAD + P + "1,0,0,0,0,0,0\n", "part.txt:3: qw: the quaternion has length 0, and 1 is"),
    (HEAD + P + "1,0,0,1,0,1,0\n", "part.txt:3: qw: the quaternion has length 1.41421, and 1"),
    (HEAD + P + "\n" + P, "part.txt:4: the same point as in line 2: remove one"),
    ("x,y,z,ux,uy,uz\n0,0,0,1,0,0\n1,0,0,0,0,0\n", "part.txt:3: ux: the direction is zero"),
    ("x,y,z\n" + "1" * 200_000 + ",0,0\n", "part.txt:2: not a CSV file: field larger"),
    (b"x,y,z\n\xff\xfe\x00\n", "part.txt:2: 3 values are expected"),
]


@pytest.mark.parametrize(("text", "message"), CSV_REFUSED)
def test_csv_refused(write, text, message):
    with pytest.raises(InputError, match=message):
        files.read_csv(write(text))


def test_csv_that_cannot_be_resampled(write):
    turning = HEAD + P + f"0,0,0,{HALF},0,0,{HALF}\n1,0,0,1,0,0,0\n"
    assert files.read_csv(write(turning)).h == 3
    with pytest.raises(InputError, match=r"part.txt:3: the tool turns on the spot since line 2"):
        files.read_csv(write(turning), points=9)
    file = write(HEAD + P + "1,0,0,1,0,0,0\n")
    with pytest.raises(InputError, match=r"part.txt:1: the file gives the rotation .*`rotation`"):
        files.read_csv(file, rotation=np.eye(3))
    with pytest.raises(InputError, match=r"points: .*both are given"):
        files.read_csv(file, points=3, step=0.1)


@pytest.mark.parametrize("read", [files.read_csv, files.read_gcode, files.read_apt])
def test_missing_file(tmp_path, read):
    with pytest.raises(MissingFileError, match=r"none.txt: no such file: check the name"):
        read(tmp_path / "none.txt")
    with pytest.raises(MissingFileError, match="directory"):
        read(tmp_path)


def test_resample_keeps_what_the_points_say(write):
    path = paths.circle(0.3, points=121, orientation="tangent", free=["spin"] * 61 + ["none"] * 60)
    for smooth, near in ((False, 1e-3), (True, 1e-6)):
        again = resample(path, points=241, smooth=smooth)
        np.testing.assert_allclose(np.hypot(*again.position[:, :2].T), 0.3, atol=near)
        np.testing.assert_array_equal(again.u[:, :3], again.tangent)
        np.testing.assert_allclose(again.rotation[::2], path.rotation, atol=1e-5)
        np.testing.assert_array_equal(again.rows, [5] * 122 + [6] * 119)
    up = resample(path.with_direction([0, 0, 1]), step=0.01)
    np.testing.assert_array_equal(up.u, [[0, 0, 1, 0, 0, 0]] * up.h)
    turning = Path(path.position[[0, 1, 1]], path.rotation[[0, 1, 2]])
    with pytest.raises(InputError, match="the tool turns on the spot at points 2 and 3"):
        resample(turning, points=9)


# G-code --------------------------------------------------------------------------------------

PART = """%
O0001 (a part; with comments)
N10 G21 G90 G17 G54 F300 S8000 M3
N20 G0 X0 Y0 Z5 ; travel
N30 G1 Z0
x10 (modal, small letters)
G3 X20 Y10 I0 J10
G2X30Y20R10
G91 G1 X10
G90 M5
M30
G1 X999
"""


def test_gcode_by_hand(write):
    path = files.read_gcode(
        write(PART), step=0.0005
    )  # fmt: skip
    assert path.length == pytest.approx(0.005 + 0.010 + math.pi * 0.010 + 0.010, abs=1e-12)
    np.testing.assert_allclose(path.position[0], [0, 0, 0.005], atol=1e-15)
    np.testing.assert_allclose(path.position[-1], [0.04, 0.02, 0], atol=1e-12)
    first = np.abs(np.hypot(path.position[:, 0] - 0.01, path.position[:, 1] - 0.01) - 0.01) < 1e-9
    assert np.count_nonzero(first) > 25  # on the first arc, centre (10, 10)
    assert np.linalg.norm(path.position - [0.02, 0.01, 0], axis=1).min() < 5e-4


@pytest.mark.parametrize(
    ("block", "turn", "end"),
    [
        ("G3 X0 Y10 I-10 J0", 90, [0, 10, 0]),
        ("G2 X0 Y10 I-10 J0", 270, [0, 10, 0]),
        ("G3 X0 Y10 R10", 90, [0, 10, 0]),
        ("G3 X0 Y10 R-10", 270, [0, 10, 0]),
        ("G2 X0 Y10 R-10", 270, [0, 10, 0]),
        ("G2 X0 Y10 R10", 90, [0, 10, 0]),
        ("G3 I-10", 360, [10, 0, 0]),
        ("G2 X10 Y0 I-10", 360, [10, 0, 0]),
        ("G18 G2 X0 Z10 I-10 K0", 90, [0, 0, 10]),
        ("G18 G3 X0 Z10 I-10 K0", 270, [0, 0, 10]),
        ("G19 G3 Y10 Z10 J10 K0", 270, [10, 10, 10]),
        ("G19 G2 Y10 Z10 J10 K0", 90, [10, 10, 10]),
    ],
)
def test_gcode_arcs(write, block, turn, end):
    path = files.read_gcode(write(f"G0 X10 Y0 Z0\n{block}\n"), points=181)
    assert path.length == pytest.approx(0.010 * math.radians(turn))
    np.testing.assert_allclose(path.position[-1], 0.001 * np.array(end), atol=1e-12)
    np.testing.assert_allclose(path.position[0], [0.01, 0, 0], atol=1e-12)


def test_gcode_direction_of_the_small_and_large_arc(write):
    for sign, turn in ((1, "G3"), (-1, "G2")):
        path = files.read_gcode(write(f"G0 X10\n{turn} X-10 I-10\n"), points=3)
        np.testing.assert_allclose(path.position[1], [0, sign * 0.01, 0], atol=1e-12)
        # R beyond the half chord: the short way leaves the chord on the outer side.
        path = files.read_gcode(write(f"G0 X10\n{turn} X-10 R12\n"), points=3)
        assert 0 < sign * path.position[1, 1] < 0.01


def test_gcode_helical_arc_inches_and_offset(write):
    file = write("G20 G0 X1 Y0 Z0\nG3 X1 Y0 Z0.5 I-1 J0\n")
    path = files.read_gcode(file, points=41, work_offset=(0, 0, 0.3))
    np.testing.assert_allclose(np.hypot(*path.position[:, :2].T), 0.0254, atol=1e-12)
    np.testing.assert_allclose(path.position[:, 2], 0.3 + np.linspace(0, 0.0127, 41), atol=1e-12)


def test_gcode_dwell_extruder_and_skipped_blocks(write):
    path = files.read_gcode(write("G1 X10 E0.5\nG4 X2\n/G1 X20 F100\n"), points=3)
    np.testing.assert_allclose(path.position[:, 0], [0, 0.01, 0.02])


def test_gcode_stretches_and_rapids(write):
    file = write("G0 X0\nG1 X10\nG0 Y5\nG1 X0\n")
    with pytest.raises(InputError, match=r"part.txt:4: .* 2 stretches, which start in lines 2, 4"):
        files.read_gcode(file, points=5)
    second = files.read_gcode(file, points=5, stretch=2)
    np.testing.assert_allclose(second.position[[0, -1]], [[0.01, 0.005, 0], [0, 0.005, 0]])
    whole = files.read_gcode(file, points=26, rapids=True)
    assert whole.length == pytest.approx(0.025)
    with pytest.raises(InputError, match="stretch: there are 2 stretches; given 3"):
        files.read_gcode(file, points=5, stretch=3)


GCODE_REFUSED = [
    ("", "part.txt: the program has no cutting move"),
    ("G0 X1\n", "the program has no cutting move"),
    ("X1\n", "part.txt:1: a position without a motion"),
    ("G1 X1\nG5 X2 Y2 I1 J1\n", "part.txt:2: G5 is not supported; known: G0 to G4"),
    ("G81 X1 Z-1 R2\n", "part.txt:1: G81 is not supported"),
    ("G41 G1 X1\n", "part.txt:1: G41 is not supported"),
    ("G28\n", "part.txt:1: G28 is not supported"),
    ("G92 X0\n", "part.txt:1: G92 is not supported"),
    ("G90.1\n", "part.txt:1: G90.1 is not supported"),
    ("G1 X1 A90\n", "part.txt:1: the axis A is not supported: .*three axes"),
    ("G1 X1 L2\n", "part.txt:1: the word L2 is unknown"),
    ("G1 X1 X2\n", "part.txt:1: X is given twice"),
    ("G1 X#5\n", "part.txt:1: cannot read 'X#5'"),
    ("G1 X[1+2]\n", r"part.txt:1: cannot read 'X\[1\+2\]'"),
    ("G1 X\n", "part.txt:1: cannot read 'X'"),
    ("G1 Xnan\n", "part.txt:1: cannot read 'Xnan'"),
    ("G1 X1e-5\n", "part.txt:1: a number such as 1e-5 is not G-code"),
    ("G1 X1\nM98 P100\n", "part.txt:2: M98 is not supported: write subprograms out"),
    ("G1 X" + "9" * 400 + "\n", r"part.txt:1: 9+\.\.\. is too long for a number"),
    ("G0 G1 X1\n", "part.txt:1: two motions in one block: G0 G1"),
    ("G3 X0 Y0 I5 P3\n", "part.txt:1: an arc of several turns"),
    ("hello world\n", "part.txt:1: cannot read 'hello world'"),
    ("G54\nG1 X1\nG55\n", "part.txt:3: G55 after G54: only one work offset"),
    ("G1 X1 I2\n", "part.txt:1: I, J, K and R belong to an arc, not to G1"),
    ("G2 X1 Y1\n", "part.txt:1: an arc in this plane needs I and J, or R"),
    ("G2 X1 Y1 K1\n", "part.txt:1: an arc in this plane needs I and J, or R"),
    ("G18 G2 X1 Z1 J1\n", "part.txt:1: an arc in this plane needs K and I, or R"),
    ("G2 X1 Y1 I1 R1\n", "part.txt:1: an arc takes its centre or R, not both"),
    ("G2 X1 Y1 I0 J0\n", "part.txt:1: the arc has no radius"),
    ("G2 R5\n", "part.txt:1: a whole circle needs its centre"),
    ("G2 X10 R2\n", "part.txt:1: a radius of 0.002 m cannot span 0.01 m"),
    ("G2 X10 Y0 I4 J0\n", "part.txt:1: the arc starts 0.004 m from its centre and ends 0.006 m"),
]


@pytest.mark.parametrize(("text", "message"), GCODE_REFUSED)
def test_gcode_refused(write, text, message):
    with pytest.raises(InputError, match=message):
        files.read_gcode(write(text), points=9)


# APT -----------------------------------------------------------------------------------------

APT = """PARTNO/A PART
$$ a comment
UNITS/MM
LOADTL/1
FEDRAT/300,MMPM
FROM/0,0,100
RAPID
GOTO/0,0,50,0,0,1
GOTO  / 10.0, 0.0, 50.0, $
  0.0, 0.6, 0.8   $$ axis
goto/20,0,50
GOTO/20,0,50
FINI
"""


def test_apt_points_and_tool_axis(write):
    path = files.read_apt(write(APT))
    np.testing.assert_allclose(
        path.position, 0.001 * np.array([[0, 0, 50], [10, 0, 50], [20, 0, 50]])
    )
    np.testing.assert_allclose(
        path.rotation[:, :, 2], [[0, 0, -1], [0, -0.6, -0.8], [0, -0.6, -0.8]], atol=1e-12
    )
    np.testing.assert_allclose(path.tangent, [[1, 0, 0]] * 3)


def test_apt_resampled_turns_the_axis_evenly(write):
    path = files.read_apt(write(APT), points=5)
    np.testing.assert_allclose(np.diff(path.arc_length), 0.005)
    middle = np.array([0, 0.3, 0.9]) / np.linalg.norm([0.3, 0.9])
    np.testing.assert_allclose(path.rotation[1][:, 2], -middle, atol=1e-9)


def test_apt_without_axis_keeps_the_given_rotation(write):
    path = files.read_apt(write("UNITS/INCHES\nGOTO/0,0,0\nGOTO/1,0,0\nGOTO/1,1,0\n"))
    np.testing.assert_allclose(path.position[-1], [0.0254, 0.0254, 0])
    np.testing.assert_array_equal(path.rotation[0], np.diag([1, -1, -1]))
    np.testing.assert_allclose(path.tangent[1], [HALF, HALF, 0])


APT_REFUSED = [
    ("", "part.txt: the program has no cutting move"),
    ("GOTO/1,2,3\n", "the program has no cutting move"),
    ("GOTO/1,2\n", "part.txt:1: three or six finite numbers are expected after GOTO/; given '1,2'"),
    ("GOTO/1,2,x\n", "part.txt:1: three or six finite numbers"),
    ("GOTO/1,2,nan\n", "part.txt:1: three or six finite numbers"),
    ("GOTO/0,0,0\nGOTO/1,2,3,0,0,2\n", "part.txt:2: the tool axis i,j,k has length 2, and 1"),
    ("GOTO/0,0,0\nGOTO/1,2,3,0,0,0\n", "part.txt:2: the tool axis i,j,k has length 0, and 1"),
    ("GOTO/0,0,0\nGOTO/0,0,0,0,1,0\n", "part.txt:2: the tool turns on the spot"),
    ("CIRCLE/1,2,3\n", "part.txt:1: CIRCLE is not supported: known: GOTO, .*write the motion"),
    ("GODLTA/1,2,3\n", "part.txt:1: GODLTA is not supported"),
    ("GOT0/1,2,3\n", "part.txt:1: GOT0 is not supported: did you mean 'GOTO'"),
    ("UNITS/FEET\n", "part.txt:1: UNITS/FEET: known: MM"),
    ("/1,2,3\n", "part.txt:1: / is not supported"),
    (
        "GOTO/0,0,0\nGOTO/1,0,0\nRAPID\nGOTO/1,1,0\nGOTO/2,1,0\n",
        "part.txt:5: travel moves cut the path into 2 stretches",
    ),
]


@pytest.mark.parametrize(("text", "message"), APT_REFUSED)
def test_apt_refused(write, text, message):
    with pytest.raises(InputError, match=message):
        files.read_apt(write(text))


# Anything at all ---------------------------------------------------------------------------

NUMBER = st.sampled_from(["0", "1", "-2.5", "10", "1e400", "nan", "0.0", "", "1,2", "--3"])
GCODE_WORDS = st.sampled_from(
    "G0 G1 G2 G3 G17 G18 G19 G20 G21 G28 G54 G90 G91 M2 M3 ; ( ) % / # X Y Z I J K R P A F".split()
)
APT_WORDS = st.sampled_from(["GOTO/", "FROM/", "RAPID", "UNITS/", "MM", "$", "$$", ",", "FEDRAT/"])
CSV_WORDS = st.sampled_from(
    ["x,y,z", "qw,qx,qy,qz", ",", "#", '"', ";", "ux,uy,uz", "0,0,0", "1,1,1"]
)
SPACE = st.sampled_from(["", " ", "\n"])


def text_of(words):
    return st.lists(st.tuples(st.one_of(words, NUMBER), SPACE).map("".join), max_size=40).map(
        "".join
    )


@pytest.mark.parametrize(
    ("read", "words"),
    [
        (lambda file: files.read_gcode(file, points=50), GCODE_WORDS),
        (lambda file: files.read_gcode(file, step=0.001, rapids=True), GCODE_WORDS),
        (files.read_apt, APT_WORDS),
        (lambda file: files.read_csv(file, points=5), CSV_WORDS),
        (lambda file: files.read_csv(file, smooth=True), CSV_WORDS),
    ],
)
def test_any_file_is_a_path_or_an_error_that_names_it(tmp_path, read, words):
    @settings(deadline=None, max_examples=150)
    @given(st.one_of(text_of(words), st.text(max_size=60)))
    def check(text):
        file = tmp_path / "any.txt"
        file.write_bytes(text.encode("utf-8", errors="surrogatepass"))
        try:
            path = read(file)
        except InputError as error:
            assert "any.txt" in str(error) or error.field in ("points", "step")
        else:
            assert np.isfinite(path.position).all()

    check()

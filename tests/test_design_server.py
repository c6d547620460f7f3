"""The server behind the design page, as a page and as a foreign web site meet it."""

import http.client
import json
import os
import re
import signal
import subprocess
import sys
import urllib.request
from contextlib import contextmanager

import numpy as np
import pytest
from paper_case import TASK, task
from patience import LONG, wait_until

from dualarm_pin.answer.folder import load_result
from dualarm_pin.cell import Cell
from dualarm_pin.design.searcher import Searcher
from dualarm_pin.design.server import Pages
from dualarm_pin.show import serving
from dualarm_pin.task import Task

CHANGE = {"base2.x": -0.1, "base2.yaw": 0.05, "workpiece.z": 0.01, "tool2.length": 0.02}
STATE = {"change": CHANGE, "smoothness": 4.0, "clearance": 0.02}


class Client:
    """One connection that stays open, as a page has it."""

    def __init__(self, address, token):
        self.host = address.split("/")[2]
        self.headers = {
            "Content-Type": "application/json", "X-Token": token, "Origin": f"http://{self.host}",
        }  # fmt: skip
        self.connection = http.client.HTTPConnection(self.host, timeout=LONG)

    def ask(self, path, message, **headers):
        """Return the status and what was answered; a frame as its head and arrays."""
        body = message if isinstance(message, bytes) else json.dumps(message).encode()
        given = {k.replace("_", "-"): v for k, v in headers.items()}
        sent = {k: v for k, v in (self.headers | given).items() if v is not None}
        self.connection.request("POST", path, body, sent)
        answer = self.connection.getresponse()
        data = answer.read()
        if answer.status != 200:
            return answer.status, data.decode()
        return 200, unpacked(data) if data[:1] != b"{" else json.loads(data)

    def move(self, page=0, search=False, motion=None, hurried=False, **state):
        message = {"page": page, "state": STATE | state, "search": search, "motion": motion}
        message["hurried"] = hurried
        return self.ask("/move", message)

    def searched(self, page=0):
        def done():
            frame = self.ask("/look", {"page": page})[1]
            return None if frame["searching"] else frame

        return wait_until(done, "the search")


def unpacked(data):
    size = int.from_bytes(data[:4], "little")
    head = json.loads(data[4 : 4 + size])
    for name in {"q", "index"} & head.keys():
        at, shape = head[name]["at"], head[name]["shape"]
        count = int(np.prod(shape))
        head[name] = np.frombuffer(data, "<f4", count, 4 + size + at).reshape(shape)
    return head


@contextmanager
def served(folder, pages=1):
    with (
        Pages(task(), folder) as pages_of,
        serving(pages_of.open, 0, pages_of.talk) as address,
    ):
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        for _ in range(pages):
            opener.open(address, timeout=LONG).read()
        yield Client(address, pages_of.talk.token)


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    with served(tmp_path_factory.mktemp("served"), pages=2) as client:
        yield client


def moved_task(saved):
    """Return the task in a folder."""
    return Task.load(saved / "task.yaml")


def test_the_motion_that_follows_is_one_of_the_moved_task(tmp_path):
    with served(tmp_path) as client:
        status, follows = client.move()
        assert status == 200
        assert follows["valid"]
        found = None
        client.move(search=True)
        found = client.searched()
        assert found["found"]["found"]
        assert client.ask("/save", {"page": 0}) == (200, {"saved": str(tmp_path)})
    there = moved_task(tmp_path)
    for frame in (follows, found):
        value = there.problem().objective(frame["q"].astype(float))
        assert value == pytest.approx(frame["objective"], rel=1e-5)
    saved, trajectory = load_result(tmp_path)
    assert trajectory.found
    assert trajectory.objective == pytest.approx(found["objective"], rel=1e-9)
    assert trajectory.index == pytest.approx(found["index"], rel=1e-5)
    assert (saved.smoothness, saved.clearance.distance) == (4.0, 0.02)
    assert Cell.load(tmp_path / "cell.yaml").arms[1].base.translation[0] == pytest.approx(2.4)


def test_limits_are_held_and_saved_and_undone(tmp_path):
    name = "arm1/joint_5"
    with served(tmp_path) as client:
        wide = client.move(limits={name: [-1.6, 1.8]}, search=True)[1]
        client.searched()
        assert client.ask("/save", {"page": 0})[0] == 200
        again = client.move()[1]
    column = task().cell.joint_names.index(name)
    limits = moved_task(tmp_path).cell
    assert (limits.lower[column], limits.upper[column]) == (-1.6, 1.8)
    assert task().cell.upper[column] < wide["q"][:, column].max() <= 1.8 + 1e-6
    assert again["q"][:, column].max() <= task().cell.upper[column] + 1e-6


def test_an_impossible_place_shows_the_last_valid_motion_says_why_and_is_not_saved(client):
    valid = client.move()[1]
    lost = client.move(change={"base2.x": 5.0}, search=True)[1]
    assert not lost["valid"]
    assert np.array_equal(lost["q"], valid["q"])
    assert "search again" in lost["why"]
    assert "no solution within the joint bounds" in client.searched()["why"]
    status, said = client.ask("/save", {"page": 0})
    assert (status, "nothing is found here yet" in said) == (400, True)
    back = client.move()[1]
    assert back["objective"] == pytest.approx(valid["objective"], rel=1e-5)


def test_a_page_that_has_the_frame_is_told_only_whether_the_search_goes_on(client):
    frame = client.move(search=True)[1]
    client.searched()
    now = client.ask("/look", {"page": 0})[1]
    assert now["frame"] > frame["frame"]  # what was found is another one
    again = client.ask("/look", {"page": 0, "frame": now["frame"]})[1]
    assert again == {"frame": now["frame"], "same": True, "searching": False}
    assert "objective" in client.ask("/look", {"page": 0, "frame": frame["frame"]})[1]
    moved = client.move(change={"base2.x": 0.01}, hurried=True)[1]
    assert moved["frame"] > now["frame"]


def test_two_pages_do_not_move_each_other(client):
    first = client.move(page=0)[1]
    client.move(page=1, change={"base2.x": 0.2})
    assert client.ask("/look", {"page": 0})[1]["objective"] == first["objective"]
    status, said = client.ask("/look", {"page": 7})
    assert (status, "open it again" in said) == (400, True)


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Host": "evil.example"}, 403),
        ({"Origin": "http://evil.example"}, 403),
        ({"Origin": None}, 403),
        ({"X_Token": "guessed"}, 403),
        ({"X_Token": "gu\xe9ssed"}, 403),
        ({"X_Token": None}, 403),
        ({"Content_Type": "text/plain"}, 415),
        ({"Content_Length": str(10**9)}, 413),
        ({"Content_Length": "9" * 5000}, 413),
        ({"Content_Length": "-1"}, 411),
        ({"Transfer_Encoding": "chunked"}, 411),
    ],
)
def test_a_request_that_no_page_of_ours_sends_is_refused_before_its_body_is_read(
    client, headers, status
):
    assert client.ask("/look", b'{"page": 0}', **headers)[0] == status
    assert client.ask("/look", {"page": 0})[0] == 200


@pytest.mark.parametrize(
    ("path", "message", "status", "said"),
    [
        ("/other", {"page": 0}, 404, "nothing answers"),
        ("/look", b"{", 400, "JSON"),
        ("/look", {"page": 0, "more": 1}, 400, "more"),
        ("/move", {"page": 0, "state": STATE | {"change": {"base2.x": 1e9}}}, 400, "base2.x"),
        ("/move", b'{"page": 0, "state": {"smoothness": NaN}}', 400, "smoothness"),
        ("/move", {"page": 0, "state": STATE | {"change": {"base9.x": 1.0}}}, 400, "base9.x"),
        ("/move", {"page": 0, "state": STATE | {"limits": {"elbow": [0, 1]}}}, 400, "elbow"),
        (
            "/move",
            {"page": 0, "state": STATE | {"limits": {"arm1/joint_1": [1, 0]}}},
            400,
            "no range",
        ),
    ],
)
def test_a_wrong_message_is_one_sentence(client, path, message, status, said):
    answer = client.ask(path, message)
    assert answer[0] == status
    assert said in answer[1]
    assert client.move()[1]["valid"]


def test_a_search_whose_process_is_ended_goes_on_here_and_nothing_is_left():
    searcher = Searcher()
    process = searcher._process
    there = searcher.search(task())
    assert there.trajectory.objective == pytest.approx(12.730887, abs=1e-4)
    assert there.slopes["base2.x"] == pytest.approx(11.86098, abs=1e-3)
    process.kill()
    again = searcher.search(task())
    assert again.trajectory.objective == there.trajectory.objective
    searcher.close()
    assert process.poll() is not None


def test_what_goes_wrong_in_a_search_is_raised_where_it_was_asked_for():
    searcher = Searcher()
    with pytest.raises(AttributeError):
        searcher.search(None)
    assert searcher.search(task()).trajectory.found
    searcher.close()


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM])
def test_the_command_serves_until_the_signal_and_leaves_nothing_behind(tmp_path, ending):
    program = subprocess.Popen(
        [sys.executable, "-m", "dualarm_pin", "design", str(TASK), "--no-browser", "--jobs", "1"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
        cwd=tmp_path,
    )  # fmt: skip
    try:
        line = program.stdout.readline()
        address = re.match(r"(http://127\.0\.0\.1:\d+/) \(Ctrl-C ends it\)", line)[1]
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        page = opener.open(address, timeout=LONG).read()
        assert b"connect-src 'self'" in page
        program.send_signal(ending)
        _, complaints = program.communicate(timeout=LONG)
        assert (program.returncode, complaints) == (0, "first motion\n")
        assert list(tmp_path.iterdir()) == []
        with pytest.raises(ProcessLookupError):
            os.killpg(program.pid, 0)
    finally:
        if program.poll() is None:
            program.kill()


def test_a_task_that_nothing_reaches_is_one_message():
    done = subprocess.run(
        [sys.executable, "-m", "dualarm_pin", "design", str(TASK), "--no-browser", "--set",
         "cell.arms.arm2.base.xyz=[9, 0, 0]"],
        capture_output=True, text=True, timeout=LONG, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert "no start reaches the whole path" in done.stderr
    assert "Traceback" not in done.stderr

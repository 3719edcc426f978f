import http.client
import re
import signal
import subprocess
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from maulstick.studio.server.link import pages_at
from maulstick.survey.answers import Answers
from maulstick.survey.questionnaire import build, read_survey
from maulstick.survey.questions import questions
from maulstick.survey.serve import listening
from tests.cli.conftest import COMMAND, run
from tests.survey.conftest import sources


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A survey that nobody has a link to."""
    build(tmp_path / "survey", "Whose strokes?", *sources(tmp_path / "sources"))
    return tmp_path / "survey"


def free_port() -> int:
    with listening("127.0.0.1", 0) as at:
        return int(at.getsockname()[1])


def test_links_are_made_and_printed_one_a_line(folder: Path) -> None:
    ran = run("survey", folder, "--links", "3", "--host", "192.168.1.20", "--port", "80")
    assert ran.code == 0
    tokens = [person.token for person in Answers(folder).participants()]
    assert ran.stdout.splitlines() == [f"http://192.168.1.20:80/{token}" for token in tokens]
    assert len(tokens) == 3


@pytest.mark.parametrize(
    "host", ["http://192.168.1.20", "192.168.1.20:80", "192.168.1.200.1", "192.168.1.256", "192.168", "a b", ""]
)
def test_no_links_are_made_that_lead_nowhere(folder: Path, host: str) -> None:
    ran = run("survey", folder, "--links", "1", "--host", host)
    assert ran.mistake == f"--host is {host!r}; it must be an address or a name of this computer, as in 192.168.1.20"
    assert Answers(folder).participants() == []


def test_links_may_name_a_host_by_its_name(folder: Path) -> None:
    assert run("survey", folder, "--links", "1", "--host", "my-pc.local").stdout.startswith("http://my-pc.local:8338/")


def test_an_address_of_six_groups_stands_in_brackets(folder: Path) -> None:
    assert run("survey", folder, "--links", "1", "--host", "::1").stdout.startswith("http://[::1]:8338/")


@pytest.mark.parametrize("host", ["0.0.0.0", "::"])
def test_links_to_all_addresses_name_one_that_a_participant_can_open(folder: Path, host: str) -> None:
    (link,) = run("survey", folder, "--links", "1", "--host", host).stdout.splitlines()
    (token,) = [person.token for person in Answers(folder).participants()]
    assert link == f"{pages_at(host, 8338)}{token}"
    assert "//0.0.0.0" not in link
    assert "//[::]" not in link


def test_results_are_two_questionnaires_and_a_csv(folder: Path) -> None:
    (token, _) = Answers(folder).mint(2)
    store = Answers(folder)
    store.begin(token)
    survey = read_survey(folder)
    for number, question in enumerate(questions(survey, store.participants()[0].seed)):
        store.answer(token, number, question, question.choices[0].name, last=number == 6)
    ran = run("survey", folder, "--results")
    assert ran.code == 0
    assert ran.stdout.splitlines()[0] == "2 links, 1 began, 1 finished"
    for told in ("Ada", "Bo", "Cy", "Curves", "Splines", "all hands"):
        assert told in ran.stdout
    assert ran.stdout.splitlines()[-1] == str(folder / "answers.csv")
    assert len((folder / "answers.csv").read_text().splitlines()) == 8


@pytest.mark.parametrize(
    ("name", "what", "words"),
    [("answers.csv", "table", ["--results"]), ("answers.sqlite", "database", ["--links", "1"])],
)
def test_a_link_in_a_survey_that_came_by_mail_is_not_written_through(
    folder: Path, tmp_path: Path, name: str, what: str, words: list[str]
) -> None:
    (tmp_path / "mine").write_bytes(b"")
    (folder / name).symlink_to(tmp_path / "mine")
    ran = run("survey", folder, *words)
    assert ran.code == 2
    assert ran.mistake == f"{folder / name} is a link; put the {what} itself in its place"
    assert (tmp_path / "mine").read_bytes() == b""


def test_one_link_is_told_in_the_singular(folder: Path) -> None:
    Answers(folder).mint(1)
    assert run("survey", folder, "--results").stdout.splitlines()[0] == "1 link, 0 began, 0 finished"


def test_a_survey_is_served_until_ctrl_c_and_says_where(folder: Path) -> None:
    port = free_port()
    (token,) = Answers(folder).mint(1)
    with subprocess.Popen(
        [COMMAND, "survey", folder, "--port", str(port)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as serving:
        assert serving.stdout is not None
        link = serving.stdout.readline().strip()
        assert link == f"http://127.0.0.1:{port}/{token}"
        assert serving.stdout.readline() == "0 of 1 participants have finished; Ctrl-C ends\n"
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)  # it waits in line until it is served
        connection.request("GET", urlsplit(link).path)
        page = connection.getresponse()
        assert page.status == 200
        assert "Whose strokes?" in page.read().decode()
        connection.close()
        serving.send_signal(signal.SIGINT)
        assert serving.wait(60) == 130
        assert serving.stderr is not None
        assert serving.stderr.read() == ""


def test_nobody_is_waited_for_without_links(folder: Path) -> None:
    ran = run("survey", folder)
    assert ran.code == 2
    assert re.fullmatch(r"nobody has a link to .* yet; make some with --links 20, then run this again", ran.mistake)


def test_a_port_that_is_in_use_is_told_in_a_line(folder: Path) -> None:
    Answers(folder).mint(1)
    with listening("127.0.0.1", 0) as at:
        port = at.getsockname()[1]
        ran = run("survey", folder, "--port", str(port))
    assert ran.code == 2
    assert ran.mistake == (
        f"cannot listen at 127.0.0.1, port {port}: Address already in use; "
        "choose another --port, or an address of this computer"
    )


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--links", "0"), "the number of new links is 0; it must be from 1 to 1000"),
        (("--port", "0"), "the port is 0; it must be from 1 to 65535"),
        (("--links", "2", "--results"), "--links and --results were both given; run one after the other"),
    ],
)
def test_what_cannot_be_done_is_told(folder: Path, words: tuple[str, ...], says: str) -> None:
    assert run("survey", folder, *words).mistake == says


@pytest.mark.parametrize("words", [(), ("--links", "2"), ("--results",)])
def test_a_file_in_place_of_the_folder_is_told(folder: Path, words: tuple[str, ...]) -> None:
    file = folder / "survey.json"
    said = f"{file} is a file; name the folder of the survey, the one with survey.json in it"
    assert run("survey", file, *words).mistake == said


def test_a_folder_without_a_survey_is_told(tmp_path: Path) -> None:
    ran = run("survey", tmp_path)
    assert ran.mistake == f"there is no survey {tmp_path / 'survey.json'}; check its name and folder"
    assert list(tmp_path.iterdir()) == []

"""XML of others: what is read, what is refused and where; BehaviorTree.CPP has the same opinion."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from explore_bt.errors import MissionError, UserError
from explore_bt.mission import load_tree
from explore_bt.mission.btcpp import read_tree_xml, tree_xml
from explore_bt.plugin import Registry

TREES = """\
trees:
  main:
    sequence:
      - {name: first, home: {}, timeout: 30 s, retry: 2}
      - fallback: [{drive: {goal: $goal}}, {repeat: {times: 3, child: {subtree: below}}}]
      - parallel: {success: 1, children: [home, {invert: home}]}
  below:
    reactive_fallback: [{if: $goal, home: {}}, {on_failure: home, home: {goal: $goal}}]
"""


@pytest.fixture
def good(tmp_path: Path, leaves: Registry) -> str:
    path = tmp_path / "trees.yaml"
    path.write_text(TREES)
    return tree_xml(load_tree(path, ["main"], leaves))


def faults_of(text: str, folder: Path, leaves: Registry) -> list[tuple[str, str]]:
    """(``line:column`` where the fault's excerpt begins, message) of every fault."""
    path = folder / "tree.xml"
    path.write_text(text)
    with pytest.raises(MissionError) as refused:
        read_tree_xml(path, leaves)
    return [(f"{fault.line}:{fault.column}", fault.message) for fault in refused.value.faults]


MUTATIONS = {
    "an unknown node": ("<Inverter>", "<Invertor>", "</Inverter>", "</Invertor>"),
    "an unknown attribute": ('msec="30000"', 'msec="30000" sec="30"'),
    "no number": ('num_cycles="3"', 'num_cycles="three"'),
    "no number of attempts": ('num_attempts="3"', 'num_attempts="some"'),
    "an empty control node": ("<Fallback>", "<Fallback/><Fallback>"),
    "two children in a decorator": ("<Inverter>", "<Inverter><home/>"),
    "a child in a leaf": ('<home name="first" />', '<home name="first"><home/></home>'),
    "a subtree that is not there": ('<SubTree ID="below"', '<SubTree ID="bellow"'),
    "a subtree without a name": ('<SubTree ID="below"', "<SubTree"),
    "a subtree with a child": ('_autoremap="true" />', '_autoremap="true"><home/></SubTree>'),
    "a main tree that is not there": ('main_tree_to_execute="main"', 'main_tree_to_execute="mian"'),
    "no main tree among several": (' main_tree_to_execute="main"', ""),
    "a tag that is not closed": ("</Inverter>", ""),
    "a tree without a node": ("</TreeNodesModel>", '</TreeNodesModel><BehaviorTree ID="empty"/>'),
    "another outermost tag": ("<root ", "<tree ", "</root>", "</tree>"),
    "nothing at all": (None,),
}

JUDGE = """
import sys, behaviortreepy as bt
factory = bt.BehaviorTreeFactory()
for leaf in ("home", "drive", "look", "entry_holds"):
    factory.register_simple_action(leaf, lambda *_: bt.NodeStatus.SUCCESS)
try:
    factory.create_tree_from_text(sys.stdin.read())
except Exception as refusal:
    print(refusal)
    sys.stdout.flush()
    __import__("os")._exit(3)
__import__("os")._exit(0)
"""


def accepted_by_behaviortree_cpp(text: str) -> bool:
    """In a process of its own: some refusals end the process that asked."""
    for port in ("goal", "entry"):  # its Python nodes have no ports
        text = re.sub(rf'(<(?:home|drive|entry_holds)\b[^>]*?) {port}="[^"]*"', r"\1", text)
    judge = subprocess.run(
        [sys.executable, "-c", JUDGE], input=text, capture_output=True, text=True, check=False
    )
    return judge.returncode == 0


def test_what_is_written_is_accepted_by_behaviortree_cpp_and_by_us(good, tmp_path, leaves) -> None:
    assert accepted_by_behaviortree_cpp(good)
    path = tmp_path / "tree.xml"
    path.write_text(good)
    assert read_tree_xml(path, leaves).name == "main"


@pytest.mark.parametrize("mutation", MUTATIONS.values(), ids=MUTATIONS.keys())
def test_what_behaviortree_cpp_refuses_is_refused_here_at_its_line(mutation, good, tmp_path, leaves) -> None:
    text = good
    if mutation == (None,):
        text = ""
    for found, put in zip(mutation[::2], mutation[1::2], strict=False):
        assert found in text
        text = text.replace(found, put, 1)
    assert not accepted_by_behaviortree_cpp(text)
    faults = faults_of(text, tmp_path, leaves)
    assert faults
    changed = [
        number
        for number, (old, new) in enumerate(zip(good.split("\n"), text.split("\n"), strict=False), 1)
        if old != new
    ]
    lines = {int(place.split(":")[0]) for place, _ in faults}
    assert not changed or any(first <= line <= first + 2 for line in lines for first in changed), faults


HEAD = '<root BTCPP_format="4">\n  <BehaviorTree ID="main">\n'
TAIL = "\n  </BehaviorTree>\n</root>\n"

REFUSED = {
    "<hoome/>": [("3:1", "there is no node hoome")],
    '<Sequence><home/>\n  <home goals="{x}"/></Sequence>': [("4:9", '<home> has no attribute "goals"')],
    "<drive/>": [("3:1", 'drive needs the port "goal"')],
    '<drive goal="here"/>': [("3:8", "goal: here is not a blackboard entry")],
    '<drive goal="$goal"/>': [("3:8", "$goal is plain text in BehaviorTree.CPP")],
    '<drive goal="{@goal}"/>': [("3:8", "{@goal} is not the name of an entry")],
    '<drive goal="{gaol}"/>': [("3:8", "drive reads $gaol (goal), which no leaf of the tree writes")],
    '<look stride="3 s"\n      turn="90 m"/>': [
        ("3:7", "stride: 3 s is not a length"),
        ("4:7", "turn: 90 m is not an angle"),
    ],
    '<look eager="yes"/>': [("3:7", "eager: yes is not true or false")],
    "<Sequence/>": [("3:1", "<Sequence> has no children")],
    "<Inverter/>": [("3:1", "<Inverter> holds exactly one node; this has none")],
    "<Timeout><home/></Timeout>": [("3:1", '<Timeout> needs the attribute "msec"')],
    '<Timeout msec="0"><home/></Timeout>': [("3:10", 'msec="0" is no time limit')],
    '<Repeat num_cycles="{n}"><home/></Repeat>': [("3:9", 'num_cycles="{n}" is not a whole number')],
    '<Repeat num_cycles="0"><home/></Repeat>': [("3:9", 'num_cycles="0" is no number of rounds')],
    '<RetryUntilSuccessful num_attempts="-1"><home/></RetryUntilSuccessful>': [
        ("3:23", 'num_attempts="-1" has no twin here')
    ],
    "<AsyncSequence><home/></AsyncSequence>": [("3:1", "AsyncSequence has no twin here")],
    '<Script code="x:=1"/>': [("3:1", "Script has no twin here")],
    '<home _skipIf="x > 1"/>': [("3:7", "_skipIf holds a script; scripts have no twin here")],
    "<Action/>": [("3:1", "<Action> has no ID")],
    '<SubTree ID="nowhere" _autoremap="true"/>': [("3:10", 'there is no tree "nowhere"')],
    '<SubTree ID="main" _autoremap="true"/>': [("3:10", "trees hold one another: main -> main")],
    '<entry_holds entry="{x}"/>': [("3:1", "entry_holds can only stand before the one node it guards")],
    '<home name="a/b"/>': [("3:7", 'the name "a/b" contains / or @')],
    "<home>text</home>": [("3:7", 'the text "text" stands between the tags')],
    "</home>": [("3:3", "not XML: mismatched tag")],
    "<home/><home/>": [("2:3", "<BehaviorTree> holds exactly one node; this has 2")],
}


@pytest.mark.parametrize(("inside", "expected"), REFUSED.items(), ids=REFUSED.keys())
def test_faults_stand_at_their_line_and_column(inside, expected, tmp_path, leaves) -> None:
    assert faults_of(HEAD + inside + TAIL, tmp_path, leaves) == expected


DOCUMENTS = {
    '<!DOCTYPE root [<!ENTITY a "b">]><root/>': "a document type is refused",
    '<!DOCTYPE root SYSTEM "file:///etc/passwd"><root/>': "a document type is refused",
    "<root>&a;</root>": "not XML: undefined entity",
    '<root BTCPP_format="3"><BehaviorTree ID="m"><home/></BehaviorTree></root>': "BTCPP_format 3 is not read",
    '<root><include path="x.xml"/><BehaviorTree><home/></BehaviorTree></root>': "<include> is not followed",
    "<root/>": "there is no tree",
    "<root>" + "<a>" * 300 + "</a>" * 300 + "</root>": "more than 20000 elements, or over 200 deep",
    '<root><BehaviorTree ID="m"><home/></BehaviorTree><BehaviorTree ID="m"><look/></BehaviorTree></root>': (
        'another tree has the ID "m"'
    ),
}


@pytest.mark.parametrize(("text", "message"), DOCUMENTS.items(), ids=DOCUMENTS.values())
def test_documents_that_cannot_be_read_are_refused_in_words(text, message, tmp_path, leaves) -> None:
    assert message in [each for _, each in faults_of(text, tmp_path, leaves)]


def test_subtrees_with_a_blackboard_of_their_own_are_refused(tmp_path, leaves) -> None:
    below = '<BehaviorTree ID="below"><home/></BehaviorTree></root>'
    text = (HEAD + '<SubTree ID="below" target="{goal}"/>' + TAIL).replace("</root>", below)
    text = text.replace('"4">', '"4" main_tree_to_execute="main">')
    assert faults_of(text, tmp_path, leaves) == [
        ("3:1", "below would have a blackboard of its own; subtrees here share one"),
        ("3:21", "target is renamed for below; subtrees here share one blackboard"),
    ]


def test_a_file_that_is_not_there_or_no_text_is_refused(tmp_path, leaves) -> None:
    with pytest.raises(MissionError, match=r"nothing\.xml  the tree cannot be read: no such file"):
        read_tree_xml(tmp_path / "nothing.xml", leaves)
    (tmp_path / "bytes.xml").write_bytes(os.urandom(7) + b"\xff\xff")
    with pytest.raises(MissionError, match="is not UTF-8 text"):
        read_tree_xml(tmp_path / "bytes.xml", leaves)


def yaml_of(inside: str, folder: Path, leaves: Registry) -> tuple[str, tuple[str, ...]]:
    path = folder / "tree.xml"
    path.write_text(HEAD + inside + TAIL)
    tree = read_tree_xml(path, leaves)
    return tree.text.split("main:", 1)[1].strip(), tree.remarks


def test_modifiers_that_stand_in_another_order_keep_it(tmp_path, leaves) -> None:
    inside = '<RetryUntilSuccessful num_attempts="3"><home/></RetryUntilSuccessful>'
    text, remarks = yaml_of(f'<Timeout msec="1500" name="slow">{inside}</Timeout>', tmp_path, leaves)
    assert text == "timeout: 1.5 s\n    sequence:\n    - retry: 2\n      home: {}"
    assert remarks[0].endswith(": timeout cannot have a name or comment; it was left out")


def test_one_attempt_is_none_more_and_an_endless_repeat_is_said(tmp_path, leaves) -> None:
    inside = '<RetryUntilSuccessful num_attempts="1"><home/></RetryUntilSuccessful>'
    text, remarks = yaml_of(f'<Repeat num_cycles="-1">{inside}</Repeat>', tmp_path, leaves)
    assert text == "repeat: {times: forever, child: home}"
    assert "repeats for ever" in remarks[0]


def test_the_long_form_and_negative_thresholds_are_read(tmp_path, leaves) -> None:
    inside = '<Action ID="home" name="a"/><Action ID="home"/>'
    parallel = f'<Parallel success_count="-2" failure_count="-1">{inside}</Parallel>'
    text, remarks = yaml_of(parallel, tmp_path, leaves)
    lines = ["parallel:", "success: 1", "failure: 2", "children:", "- name: a", "home: {}", "- home"]
    assert [line.strip() for line in text.split("\n")] == lines
    assert remarks == ()


def test_what_xml_cannot_say_is_refused_or_left_out(tmp_path, leaves) -> None:
    path = tmp_path / "trees.yaml"
    path.write_text("trees: {main: {look: {nothing: []}}}")
    with pytest.raises(
        UserError, match=r"trees.yaml:1:\d+: nothing: the list \[\] cannot be written as an XML"
    ):
        tree_xml(load_tree(path, ["main"], leaves))
    path.write_text("trees: {main: {timeout: 1.5 ms, look: {}}}")
    text = tree_xml(load_tree(path, ["main"], leaves))
    assert 'msec="2"' in text
    assert "were rounded" in text
    assert '<input_port name="nothing" type="tuple">' in text

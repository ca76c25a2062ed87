"""Imported trees do, tick by tick, what BehaviorTree.CPP's documentation says they do.

Letters are answers in consecutive ticks: R runs, S succeeds, F fails, a dot was not ticked.
"""

import pytest
from foreign_runs import document, run

SEQ_A_B_C = '<{0}><A name="a"/><B name="b"/><C name="c"/></{0}>'

TABLE = {
    # A Sequence goes on where it was, and begins anew after a failure.
    "Sequence": (SEQ_A_B_C, {"A": "RS", "B": "RRF S", "C": "S"}, "RRRFRS", "RS..RS", ".RRF.S"),
    # A ReactiveSequence asks the first again in every tick, and halts what it no longer allows.
    "ReactiveSequence": (SEQ_A_B_C, {"A": "S S F S", "B": "RRRRS"}, "RRFRR", "SSFSS", "RR.RR"),
    # A SequenceWithMemory does not repeat what has succeeded, not even after a failure.
    "SequenceWithMemory": (SEQ_A_B_C, {"A": "S", "B": "F F S", "C": "S"}, "FFS", "S..", "FFS"),
    "Fallback": (SEQ_A_B_C, {"A": "RF", "B": "RRS", "C": "S"}, "RRRS", "RF..", ".RRS"),
    "ReactiveFallback": (SEQ_A_B_C, {"A": "F F S", "B": "RRRS"}, "RRS", "FFS", "RR."),
}


@pytest.mark.parametrize("control", TABLE)
def test_composites_restart_and_halt_as_documented(tmp_path, control):
    xml, scripts, answers, a, b = TABLE[control]
    ran = run(tmp_path, xml.format(control), scripts).tick(len(answers))
    assert (ran.answers, ran.doing["a"], ran.doing["b"]) == (answers, a, b)


PARALLEL = '<Parallel {}><A name="a"/><B name="b"/><C name="c"/></Parallel>'


@pytest.mark.parametrize(
    ("ports", "scripts", "answers"),
    [
        ("", {"A": "S", "B": "RS", "C": "RRS"}, "RRS"),  # all, and one failure is enough
        ("", {"A": "S", "B": "RF", "C": "RRS"}, "RF"),
        ('success_count="1" failure_count="3"', {"A": "F", "B": "RS", "C": "RRS"}, "RS"),
        ('success_count="2" failure_count="2"', {"A": "S", "B": "RF", "C": "RRF"}, "RRF"),
        ('success_count="2" failure_count="-1"', {"A": "F", "B": "RS", "C": "RRS"}, "RRS"),
        ('success_count="-2" failure_count="2"', {"A": "F", "B": "RS", "C": "RRS"}, "RRS"),
        ('success_count="-1" failure_count="-1"', {"A": "F", "B": "RS", "C": "RRS"}, "F"),
    ],
)
def test_parallel_counts_from_the_end_when_negative(tmp_path, ports, scripts, answers):
    ran = run(tmp_path, PARALLEL.format(ports), scripts).tick(len(answers))
    assert ran.answers == answers


@pytest.mark.parametrize(
    ("ports", "scripts", "answers"),
    [
        ("", {"A": "F", "B": "RS", "C": "RRS"}, "RRF"),
        ('max_failures="2"', {"A": "F", "B": "RS", "C": "RRS"}, "RRS"),
        ('max_failures="-1"', {"A": "F", "B": "RF", "C": "RRF"}, "RRF"),
        ('max_failures="-1"', {"A": "F", "B": "RF", "C": "RRS"}, "RRS"),
    ],
)
def test_parallel_all_waits_for_everybody(tmp_path, ports, scripts, answers):
    xml = PARALLEL.format(ports).replace("Parallel", "ParallelAll")
    assert run(tmp_path, xml, scripts).tick(len(answers)).answers == answers


@pytest.mark.parametrize(
    ("attempts", "script", "answers"),
    [("3", "F F S", "RRS"), ("2", "F", "RFRF"), ("-1", "F F F F F F F S", "RRRRRRRS")],
)
def test_retry_ends_with_a_success_or_its_last_attempt(tmp_path, attempts, script, answers):
    xml = f'<RetryUntilSuccessful num_attempts="{attempts}"><A/></RetryUntilSuccessful>'
    assert run(tmp_path, xml, {"A": script}).tick(len(answers)).answers == answers


@pytest.mark.parametrize(
    ("cycles", "script", "answers"),
    [("2", "S", "RS"), ("3", "S F", "RF"), ("-1", "S S S F", "RRRF")],
)
def test_repeat_ends_with_a_failure_or_its_last_cycle(tmp_path, cycles, script, answers):
    xml = f'<Repeat num_cycles="{cycles}"><A/></Repeat>'
    assert run(tmp_path, xml, {"A": script}).tick(len(answers)).answers == answers


def test_keep_running_until_failure(tmp_path):
    xml = "<KeepRunningUntilFailure><A/></KeepRunningUntilFailure>"
    assert run(tmp_path, xml, {"A": "S RS F"}).tick(4).answers == "RRRF"


@pytest.mark.parametrize(
    ("decorator", "script", "answers"),
    [("Inverter", "RS F", "RFS"), ("ForceSuccess", "RF S", "RSS"), ("ForceFailure", "RS F", "RFF")],
)
def test_answers_are_turned_and_forced(tmp_path, decorator, script, answers):
    xml = f"<{decorator}><A/></{decorator}>"
    assert run(tmp_path, xml, {"A": script}).tick(3).answers == answers


def test_timeout_is_in_milliseconds_and_halts_the_child(tmp_path):
    ran = run(tmp_path, '<Timeout msec="250"><A name="a"/></Timeout>', {"A": "RRRRRS"}).tick(4)
    assert (ran.answers, ran.doing["a"]) == ("RRRF", "RRR.")


def test_delay_and_sleep_wait_on_the_clock(tmp_path):
    ran = run(tmp_path, '<Delay delay_msec="200"><A name="a"/></Delay>', {"A": "S"}).tick(3)
    assert (ran.answers, ran.doing["a"]) == ("RRS", "..S")
    assert run(tmp_path, '<Sleep msec="200"/>', {}).tick(3).answers == "RRS"


IF = "<{0}><A name='a'/><B name='b'/><C name='c'/></{0}>"


def test_if_then_else_decides_once(tmp_path):
    ran = run(tmp_path, IF.format("IfThenElse"), {"A": "S F", "B": "RRS", "C": "S"}).tick(4)
    assert (ran.answers, ran.doing["a"], ran.doing["c"]) == ("RRSS", "S..F", "...S")


def test_if_then_else_without_else_fails(tmp_path):
    xml = "<IfThenElse><A/><B/></IfThenElse>"
    assert run(tmp_path, xml, {"A": "F S", "B": "S"}).tick(2).answers == "FS"


def test_while_do_else_asks_in_every_tick_and_halts_the_other_branch(tmp_path):
    ran = run(tmp_path, IF.format("WhileDoElse"), {"A": "S S F", "B": "RRRS", "C": "RS"}).tick(4)
    assert (ran.answers, ran.doing["b"], ran.doing["c"]) == ("RRRS", "RR..", "..RS")


def test_switch_compares_texts_and_falls_back_to_its_last_child(tmp_path):
    xml = (
        "<Sequence><Script code=\"kind := '{}'\"/>"
        '<Switch2 variable="{{kind}}" case_1="red" case_2="7">'
        '<A name="a"/><B name="b"/><C name="c"/></Switch2></Sequence>'
    )
    for kind, chosen in (("red", "a"), ("7", "b"), ("blue", "c")):
        ran = run(tmp_path, xml.format(kind), {"A": "S", "B": "S", "C": "S"}).tick()
        assert [name for name, did in ran.doing.items() if did == "S"] == [chosen]


def test_run_once_answers_the_same_or_is_skipped(tmp_path):
    same = '<RunOnce then_skip="false"><A name="a"/></RunOnce>'
    ran = run(tmp_path, same, {"A": "RF S"}).tick(4)
    assert (ran.answers, ran.doing["a"]) == ("RFFF", "RF..")
    skipped = '<Sequence><RunOnce><A name="a"/></RunOnce><B name="b"/></Sequence>'
    ran = run(tmp_path, skipped, {"A": "F S", "B": "S"}).tick(3)
    assert (ran.answers, ran.doing["a"], ran.doing["b"]) == ("FSS", "F..", ".SS")


def test_loops_run_the_child_for_each_item(tmp_path):
    xml = '<LoopDouble queue="1;2.5" value="{x}"><Script code="y := x * 2"/></LoopDouble>'
    ran = run(tmp_path, xml, {}).tick(2)
    assert ran.answers[-1] == "S"
    assert ran.value("y") == 5.0


def test_a_skipped_child_counts_for_nothing(tmp_path):
    """In a Sequence it is passed over like a success, in a Fallback like a failure."""
    xml = (
        '<Sequence><Script code="skip := true"/><{0}>'
        '<A name="a" _skipIf="skip"/><B name="b"/></{0}></Sequence>'
    )
    for control, answer in (("Sequence", "F"), ("Fallback", "S")):
        ran = run(tmp_path, xml.format(control), {"A": "F", "B": answer})
        ran.tick()
        assert (ran.answers, ran.doing["a"], ran.doing["b"]) == (answer, ".", answer)


def test_success_and_failure_conditions_are_asked_when_a_node_starts(tmp_path):
    xml = (
        '<Sequence><Script code="n := 1"/>'
        '<A name="a" _successIf="n == 1" _onSuccess="n := 5"/>'
        '<B name="b" _failureIf="n == 5" _onFailure="n := 6"/></Sequence>'
    )
    ran = run(tmp_path, xml, {"A": "F", "B": "S"}).tick()
    assert (ran.answers, ran.doing["a"], ran.doing["b"]) == ("F", ".", ".")
    assert ran.value("n") == 6


@pytest.mark.parametrize("ending", ["", '_onFailure="done := 2"'])
@pytest.mark.parametrize(("control", "answer"), [("Sequence", "S"), ("Fallback", "S")])
def test_while_halts_and_passes_over(tmp_path, control, answer, ending):
    """`_while` skips a node that runs: its parent goes on with the next child."""
    ran = run(
        tmp_path,
        '<Sequence><Script code="go := true; done := 0"/><Parallel success_count="2" '
        'failure_count="2"><Sequence><A name="a"/><Script code="go := false"/></Sequence>'
        f'<{control}><B name="b" _while="go" {ending}/><C name="c"/></{control}>'
        "</Parallel></Sequence>",
        {"A": "RS", "B": "RRRRS", "C": "S"},
    ).tick(2)
    assert ran.doing["b"] == "R."
    assert ran.doing["c"] == ".S"
    assert ran.answers[-1] == answer
    assert ran.value("done") == 0


def test_a_subtree_shares_only_what_is_remapped(tmp_path):
    more = '<BehaviorTree ID="Inner"><Script code="result := goal + 1; own := 3"/></BehaviorTree>'
    body = (
        '<Sequence><Script code="target := 1; own := 0"/>'
        '<SubTree ID="Inner" goal="{target}" result="{answer}"/></Sequence>'
    )
    ran = run(tmp_path, document(body, more=more), {}).tick()
    assert (ran.answers, ran.value("answer"), ran.value("own")) == ("S", 2, 0)


def test_autoremap_shares_every_key_of_the_same_name(tmp_path):
    more = '<BehaviorTree ID="Inner"><Script code="b := a + 1; _mine := 1"/></BehaviorTree>'
    body = (
        '<Sequence><Script code="a := 1; b := 0"/><SubTree ID="Inner" _autoremap="true"/>'
        '<ScriptCondition code="b == 2"/></Sequence>'
    )
    ran = run(tmp_path, document(body, more=more), {}).tick()
    assert (ran.answers, ran.value("b")) == ("S", 2)


def test_a_key_that_a_subtree_reads_and_writes_is_handed_in_and_out(tmp_path):
    more = '<BehaviorTree ID="Count"><Script code="n += 1"/></BehaviorTree>'
    body = (
        '<Sequence><Script code="total := 5"/><SubTree ID="Count" n="{total}"/>'
        '<SubTree ID="Count" n="{total}"/></Sequence>'
    )
    ran = run(tmp_path, document(body, more=more), {}).tick()
    assert (ran.answers, ran.value("total")) == ("S", 7)


def test_on_halted_runs_when_a_running_node_is_halted(tmp_path):
    xml = (
        '<Sequence><Script code="halted := 0"/><Fallback><Timeout msec="150">'
        '<A _onHalted="halted += 1"/></Timeout><AlwaysSuccess/></Fallback></Sequence>'
    )
    ran = run(tmp_path, xml, {"A": "RRRRRS"}).tick(3)
    assert (ran.answers, ran.value("halted")) == ("RRS", 1)


def test_post_runs_after_either_answer(tmp_path):
    forced = '<ForceSuccess><A _post="n += 1"/></ForceSuccess>'
    xml = f'<Sequence><Script code="n := 0"/>{forced}</Sequence>'
    ran = run(tmp_path, xml, {"A": "F"}).tick()
    assert ran.value("n") == 1

"""Who lets a world go on, and when."""

import threading
import time

from simulation.turns import Turns


def test_steps_of_two_threads_do_not_mix() -> None:
    turns, inside, most = Turns(), [], []

    def steps() -> None:
        for _ in range(50):
            with turns.step():
                inside.append(1)
                most.append(len(inside))
                time.sleep(0)
                inside.pop()

    threads = [threading.Thread(target=steps) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert most == [1] * 150


def test_who_goes_first_need_not_wait_for_a_thread_that_steps_on_and_on() -> None:
    turns, seen, stop = Turns(), [], threading.Event()

    def steps() -> None:
        while not stop.is_set():
            with turns.step():
                seen.append("step")

    thread = threading.Thread(target=steps)
    thread.start()
    while not seen:
        time.sleep(0.001)
    with turns.first():
        before = len(seen)
        time.sleep(0.02)
        after = len(seen)
    stop.set()
    thread.join(timeout=5.0)

    assert before == after
    assert not thread.is_alive()


def test_the_world_goes_on_after_what_failed_in_between() -> None:
    turns = Turns()
    try:
        with turns.first():
            raise RuntimeError("brakes")
    except RuntimeError:
        pass

    with turns.step(), turns.look():
        pass

"""Progress, stopping and work on many items."""

from __future__ import annotations

import threading
import time

import pytest

from graphos_core.errors import Stopped
from graphos_core.run import Run, each, map_items


class Listener(Run):
    def __init__(self, threads: int) -> None:
        super().__init__(threads=threads)
        self.told: list[tuple[float, float, str]] = []

    def progress(self, done: float, total: float, what: str) -> None:
        self.told.append((done, total, what))


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_results_come_in_the_order_of_the_items(threads: int) -> None:
    run = Listener(threads)
    assert map_items(run, lambda i: i * i, range(20), "numbers") == [i * i for i in range(20)]
    assert run.told[-1] == (20, 20, "numbers")


@pytest.mark.parametrize("threads", [1, 2])
def test_the_first_exception_is_raised(threads: int) -> None:
    def fail(i: int) -> int:
        if i == 3:
            raise ValueError("three")
        return i

    with pytest.raises(ValueError, match="three"):
        map_items(Listener(threads), fail, range(10), "numbers")


def test_a_function_that_raises_timeout_is_not_waited_for_forever() -> None:
    def fail(i: int) -> int:
        raise TimeoutError("own")

    with pytest.raises(TimeoutError, match="own"):
        map_items(Listener(2), fail, range(4), "numbers")


def test_stopping_takes_effect_within_a_second() -> None:
    run = Listener(2)
    threading.Timer(0.1, run.stop).start()
    started = time.monotonic()
    with pytest.raises(Stopped):
        map_items(run, lambda i: time.sleep(0.05), range(1000), "naps")
    assert time.monotonic() - started < 1.0


def test_each_stops_between_items() -> None:
    run = Listener(1)
    seen = []
    with pytest.raises(Stopped):
        for item in each(run, range(10), "numbers"):
            seen.append(item)
            if item == 4:
                run.stop()
    assert seen == [0, 1, 2, 3, 4]

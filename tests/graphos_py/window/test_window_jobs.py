"""Jobs: progress arrives, stopping is quick, threads are released, nothing is lost."""

import time

import pytest

from graphos_core.errors import UserError
from graphos_core.run import each
from graphos_py.jobs import ENGINE, Job, TimeLeft


class Listener:
    def __init__(self, job: Job) -> None:
        self.progress: list[tuple[float, float, str]] = []
        self.shown: list[object] = []
        job.progressed.connect(lambda *a: self.progress.append(a))
        job.shown.connect(lambda key, values: self.shown.extend(values))


def test_a_job_tells_progress_and_its_result(qtbot, jobs):
    def work(run):
        for _ in each(run, range(5), "pairs"):
            time.sleep(0.06)
        return 42

    job = Job(work)
    heard = Listener(job)
    with qtbot.waitSignal(job.succeeded) as result:
        jobs.start(job)
    assert result.args == [42]
    assert heard.progress[-1] == (5.0, 5.0, "pairs")
    assert len(heard.progress) >= 4


def test_stopping_takes_effect_within_a_second_and_releases_the_thread(qtbot, jobs):
    def work(run):
        while True:
            run.check()
            time.sleep(0.02)

    job = jobs.start(Job(work))
    qtbot.wait(100)
    started = time.monotonic()
    with qtbot.waitSignals([job.stopped, jobs.idle], timeout=1000):
        job.stop()
    assert time.monotonic() - started < 1.0
    assert jobs.running == ()
    assert not ENGINE.locked()


def test_a_thousand_partial_results_arrive_in_order_and_none_is_lost(qtbot, jobs):
    def work(run):
        for i in range(1000):
            run.show("iteration", i)
            run.progress(i, 1000, "iterations")

    job = Job(work)
    heard = Listener(job)
    with qtbot.waitSignal(jobs.idle):
        jobs.start(job)
    assert heard.shown == list(range(1000))
    assert len(heard.progress) < 200, "progress is throttled"


def test_a_thousand_signals_of_several_threads_survive(qtbot, jobs):
    def work(run):
        for i in range(250):
            run.say(f"{run.seed}:{i}")

    said: list[str] = []
    made = [Job(work, seed=seed, engine=False) for seed in range(4)]
    for job in made:
        job.said.connect(said.append)
    with qtbot.waitSignal(jobs.idle):
        for job in made:
            jobs.start(job)
    assert sorted(said) == sorted(f"{seed}:{i}" for seed in range(4) for i in range(250))


def test_a_failure_arrives_as_the_exception_itself(qtbot, jobs):
    def work(run):
        raise UserError("No photos.", "It is empty.", "Choose another.")

    job = Job(work)
    with qtbot.waitSignal(job.failed) as told:
        jobs.start(job)
    assert told.args[0].todo == "Choose another."


def test_engine_jobs_run_one_after_the_other_and_can_be_stopped_while_waiting(qtbot, jobs):
    def work(run):
        while True:
            run.check()
            time.sleep(0.01)

    first = jobs.start(Job(work))
    qtbot.waitUntil(ENGINE.locked)
    second = jobs.start(Job(lambda run: pytest.fail("must not start")))
    qtbot.wait(150)
    with qtbot.waitSignal(second.stopped, timeout=1000):
        second.stop()
    with qtbot.waitSignal(first.stopped, timeout=1000):
        first.stop()


def test_time_left_follows_the_rate():
    now = [0.0]
    left = TimeLeft(lambda: now[0])
    assert left.seconds(0, 100, "pairs") is None
    now[0] = 2.0
    assert left.seconds(20, 100, "pairs") == pytest.approx(8.0)
    assert left.seconds(1, 50, "photos") is None, "another kind of item starts anew"

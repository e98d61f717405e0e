"""How a stage tells progress, shows partial results, and learns that it should stop."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TextIO, TypeVar

from graphos_core.errors import Stopped

Item = TypeVar("Item")
Result = TypeVar("Result")


class Run:
    """The only way a stage talks to whoever called it; this one is silent and never stops.

    Subclasses exist for the command line, the window, tests and notebooks. A stage knows only these methods.

    Attributes
    ----------
    threads : int
        How many threads `map_items` may use; results do not depend on it.
    seed : int
        Seed of every random step, from the recipe.
    warnings : list of str
        What `warn` was told.
    """

    def __init__(self, *, threads: int | None = None, seed: int = 0) -> None:
        self.threads = max(1, threads or os.cpu_count() or 1)
        self.seed = seed
        self.warnings: list[str] = []
        self._stop = threading.Event()

    def progress(self, done: float, total: float, what: str) -> None:
        """Tell that `done` of `total` units of `what` are finished."""

    def say(self, text: str) -> None:
        """Tell one sentence for the log."""

    def warn(self, text: str) -> None:
        """Tell one sentence that belongs into the report's warnings; subclasses call this one too."""
        self.warnings.append(text)

    def show(self, key: str, value: Any) -> None:
        """Offer a partial result (an iteration record, an intermediate image) to whoever looks."""

    def stop(self) -> None:
        """Ask the work to stop; may be called from another thread."""
        self._stop.set()

    def stopping(self) -> bool:
        """Say whether the work should stop now."""
        return self._stop.is_set()

    def check(self) -> None:
        """Raise `Stopped` if the work should stop now."""
        if self.stopping():
            raise Stopped


class ConsoleRun(Run):
    """Progress on a terminal: one line that is rewritten, or one line per stage when not a terminal."""

    def __init__(self, stream: TextIO, *, threads: int | None = None, seed: int = 0) -> None:
        super().__init__(threads=threads, seed=seed)
        self._stream = stream
        self._live = stream.isatty()
        self._last = 0.0
        self._open = False

    def progress(self, done: float, total: float, what: str) -> None:
        """Rewrite the progress line at most ten times a second."""
        now = time.monotonic()
        if self._live and (now - self._last > 0.1 or done >= total):
            share = 100.0 * done / total if total else 100.0
            self._stream.write(f"\r\x1b[K  {what} {share:3.0f} %")
            self._stream.flush()
            self._last, self._open = now, True

    def say(self, text: str) -> None:
        """Print the sentence on a line of its own."""
        if self._open:
            self._stream.write("\r\x1b[K")
            self._open = False
        print(text, file=self._stream, flush=True)

    def warn(self, text: str) -> None:
        """Print the warning and keep it for the report."""
        super().warn(text)
        self.say(f"Warning: {text}")


def each(run: Run, items: Sequence[Item], what: str) -> Iterator[Item]:
    """Iterate over `items`, telling progress and stopping when asked.

    Parameters
    ----------
    run : Run
    items : sequence
    what : str
        What the items are, in plural: ``"pairs"``.

    Raises
    ------
    Stopped
        When the person asked to stop.
    """
    for done, item in enumerate(items):
        run.check()
        run.progress(done, len(items), what)
        yield item
    run.progress(len(items), len(items), what)


def map_items(
    run: Run,
    function: Callable[[Item], Result],
    items: Sequence[Item],
    what: str,
    *,
    threads: int | None = None,
) -> list[Result]:
    """Apply `function` to every item, in threads, and return the results in the order of the items.

    Independent work (one photo, one pair, one depth map) goes through here. `function` is pure, so the result
    does not depend on the number of threads. The first exception ends the work and is raised.

    Parameters
    ----------
    run : Run
    function : callable
        Takes one item; top-level and picklable, or a `functools.partial` of such a function.
    items : sequence
    what : str
        What the items are, in plural.
    threads : int, optional
        Fewer threads than `run.threads`, where the function threads by itself or needs much memory.

    Raises
    ------
    Stopped
        When the person asked to stop.
    """
    workers = min(threads or run.threads, run.threads, max(1, len(items)))
    if workers == 1:
        return [function(item) for item in each(run, items, what)]
    results: list[Result] = []
    with ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(function, item) for item in items]
        try:
            for done, future in enumerate(futures):
                while True:
                    run.check()
                    try:
                        results.append(future.result(timeout=0.2))
                        break
                    except TimeoutError:
                        if future.done():
                            raise
                run.progress(done + 1, len(items), what)
        except BaseException:
            for future in futures:
                future.cancel()
            raise
    return results

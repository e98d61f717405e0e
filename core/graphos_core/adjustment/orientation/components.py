"""Several components: photos that cannot be connected make blocks of their own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from threadpoolctl import threadpool_limits

from graphos_core.adjustment.orientation.groups import explain_failures, listed
from graphos_core.adjustment.orientation.growth import Growth
from graphos_core.data import Block, PairMatches
from graphos_core.errors import ParamError, UserError
from graphos_core.features.graph import components
from graphos_core.run import Run
from graphos_core.text import Text


def grow_blocks(
    groups: Sequence[tuple[int, ...]],
    pairs: Sequence[PairMatches],
    grown: Callable[[tuple[int, ...]], Growth],
    run: Run,
) -> list[Growth]:
    """Orient every group, and again what each leaves over, as long as anything can be oriented.

    Parameters
    ----------
    groups : sequence of tuple of int
        In the order in which they are tried.
    pairs : sequence of PairMatches
        Verified pairs: they tell what hangs together in what is left over.
    grown : callable
        Orients one group, or raises `UserError`.
    run : Run

    Returns
    -------
    list of Growth
        Finished, in the order of the groups.

    Raises
    ------
    UserError
        The first reason, when nothing could be oriented.
    """
    waiting, done = list(groups), list[Growth]()
    problem: UserError | None = None
    with threadpool_limits(limits=1, user_api="blas"):  # threaded BLAS changes the last bits
        while waiting:
            group = waiting.pop(0)
            run.check()
            try:
                growth = grown(group)
            except UserError as error:
                problem = problem or error
                continue
            growth.finish()
            done.append(growth)
            left = [photo for photo in group if not growth.block.oriented[photo]]
            inner = [pair for pair in pairs if pair.a in left and pair.b in left]
            count = len(growth.block.names)
            waiting += [part for part in components(count, inner) if len(part) > 1]
    if not done:
        assert problem is not None
        raise problem
    return done


def main_block(
    growths: Sequence[Growth],
    groups: Sequence[tuple[int, ...]],
    component: int,
    chosen: tuple[int, ...],
    run: Run,
) -> Block:
    """Return the block that is asked for, with the others beside it and a reason for every photo outside it.

    Parameters
    ----------
    growths : sequence of Growth
        Finished.
    groups : sequence of tuple of int
        Photos that hang together by verified pairs.
    component : int
        1 for the largest block, 2 for the second …
    chosen : tuple of int
        Photos whose block comes first whatever its size.
    run : Run

    Raises
    ------
    ParamError
        When there are fewer blocks.
    """

    def rank(growth: Growth) -> tuple[bool, int]:
        return not (chosen and growth.block.oriented[list(chosen)].all()), -growth.count

    ordered = sorted(growths, key=rank)
    if component > len(ordered):
        raise ParamError("component", Text("Which block: {k}, there are {n}", k=component, n=len(ordered)))
    main = ordered.pop(component - 1)
    names = main.block.names
    parts = [tuple(i for i in growth.group if growth.block.oriented[i]) for growth in ordered]
    reasons = {photo: reason for growth in growths for photo, reason in growth.reasons.items()}
    homes = [group for group in groups if main.block.oriented[list(group)].any()]
    strangers = [group for group in groups if group not in homes]
    failures = explain_failures(names, main.block.oriented.tolist(), [*parts, *homes, *strangers], reasons)
    for part in parts:
        run.warn(Text("{count} photos cannot be connected with the others; they are kept as a block of their own: "
                      "{names}.", count=len(part), names=listed([names[i] for i in part])))  # fmt: skip
    for group in strangers:
        if not any(set(part) & set(group) for part in parts):
            run.warn(Text("{count} photos form a group of their own and were not oriented: {names}.",
                          count=len(group), names=listed([names[i] for i in group])))  # fmt: skip
    run.progress(main.count, len(names), "photos oriented")
    return replace(main.block.block(failures), others=tuple(growth.block.block() for growth in ordered))

"""Bundle adjustment: exterior and interior orientation and object points together, by least squares.

The entry is `adjust_block` of `graphos_core.adjustment.bundle.adjust`::

    adjust_block(block, Freedom(interior=(("focal_px", "k1", "k2"),), fixed_points=mask),
                 Options(robust="huber", scale_px=1.0, statistics=False), run=run) -> Adjustment
"""
